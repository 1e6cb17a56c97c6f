// A map that is corrected by what a diagnosis found, in worlds with an effect that no cause of the
// catalogue is: it is never farther off than the map without by more than the U95 that it states.
// The truth is the machine of the rig. Worlds: ABBE_SEEDS, ABBE_SHARD.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../folders.h"
#include "apps/causes_option.h"
#include "diagnosis/found_model.h"
#include "fusion/fuse.h"
#include "random/counter_random.h"
#include "rig/world.h"
#include "simulation/kinds.h"
#include "tests/hidden_effects/judgement.h"
#include "tests/recording/scratch.h"
#include "tests/seeds.h"

namespace abbe {
namespace corrected_map_test {

using Eigen::Vector3d;

const std::filesystem::path kMachine = DemoMillFile();
constexpr int kPoints = 5;  // along each travel

// Deviation of a map from the machine and its U95, three components at each point, m.
struct Judged {
  Eigen::Matrix3Xd off, u95;

  double Rms() const { return std::sqrt(off.squaredNorm() / static_cast<double>(off.cols())); }
};

// What the machine really does where it has its tool, in W.
Vector3d TrueError(const rig::World& world, const machine::Chain& chain, const Vector3d& axes) {
  const auto table = world.PoseOfTarget(axes);
  const Vector3d tool = world.PoseOfHead(axes) * Vector3d::Zero();
  return table.rotation.transpose() * (tool - table.translation) - relm::NominalTip(chain, axes);
}

Judged Judge(const rig::World& world, const map::ErrorMap& map) {
  Judged judged{Eigen::Matrix3Xd::Zero(3, kPoints * kPoints * kPoints), {}};
  judged.u95 = judged.off;
  for (Eigen::Index point = 0; point < judged.off.cols(); ++point) {
    Vector3d at;
    Eigen::Index place = point;
    for (std::size_t axis = 0; axis < 3; ++axis, place /= kPoints) {
      const auto& travel = map.model().travels()[axis];
      at[static_cast<Eigen::Index>(axis)] =
          travel.first +
          (travel.last - travel.first) * static_cast<double>(place % kPoints) / (kPoints - 1);
    }
    const Vector3d& tool = map.origin().tool;
    judged.off.col(point) = map.Error(at, tool) - TrueError(world, map.model().chain(), at);
    judged.u95.col(point) = 2.0 * map.StandardUncertainty(at, tool);
  }
  return judged;
}

fusion::FuseReport MapOf(const simulation::Instruments& instruments,
                         const std::vector<recording::Recording>& recordings,
                         const fusion::Doubt& doubt = {}) {
  const auto model = fusion::UnknownMachine(instruments.machine);
  std::vector<simulation::SimulatedRun> runs;
  for (const auto& recording : recordings) {
    if (!simulation::KindOf(recording).MakesMaps()) continue;
    for (auto& run :
         simulation::SimulateForMap(simulation::SourceOf(recording), model, instruments)) {
      runs.push_back(std::move(run));
    }
  }
  return fusion::Fuse(instruments.machine, runs, {.doubt = doubt});
}

std::filesystem::path Written(const simulation::ExtendedModel& model) {
  static const recording::Scratch folder;
  const auto path = folder / "model.toml";
  std::ofstream(path) << simulation::ExtendedModelText(model);
  return path;
}

TEST(CorrectedMap, IsNeverWorseThanWithoutByMoreThanItsU95) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const apps::MachineFile file = apps::ReadMachineFile(kMachine);
  Rate refused, changed, rms;
  const Seeds seeds = SeedsFromEnvironment();
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const std::string hidden = DrawHidden(random::CounterRandom(seed, 0xC0EC), 0, false);
    const auto campaign = worlds.Record(seed, {hidden});
    const diagnosis::Campaign read = worlds.Recordings(campaign);
    const Diagnosis diagnosis = diagnosis::Diagnose(read);
    const auto model = Written(diagnosis::FoundModel(diagnosis, read, {}));
    const bool unexplained = diagnosis.verdict == Verdict::kUnexplained;
    refused.Add(unexplained);
    if (unexplained) {
      EXPECT_THROW(apps::CauseCorrection({model, false}, file, apps::kForMaps), InputError);
    }
    apps::CauseCorrection causes({model, true}, file, apps::kForMaps);
    std::vector<recording::Recording> corrected, certain;
    for (const auto& recording : campaign.recordings) {
      corrected.push_back(causes.Take(recording));
      certain.push_back(causes.TakeCertain(recording));
    }
    const auto without = MapOf(worlds.setup(), campaign.recordings);
    const auto other = MapOf(worlds.setup(), certain);
    const auto with = MapOf(worlds.setup(), corrected,
                            {.other = &other.map, .displacement = causes.unexplained()});
    const rig::World world(worlds.machine().rig, seed);
    const Judged before = Judge(world, without.map), after = Judge(world, with.map);
    const Eigen::Array3Xd worse = after.off.array().abs() - before.off.array().abs();
    const double beyond = (worse - after.u95.array()).maxCoeff();
    changed.Add(worse.abs().maxCoeff() > 1e-9);
    rms.Add(after.Rms() <=
            before.Rms() + after.u95.norm() / std::sqrt(static_cast<double>(after.off.cols())));
    fmt::print("{} {} {}, {} causes: {:.2f} um rms off without, {:.2f} with, U95 {:.2f}\n", seed,
               hidden, Name(diagnosis.verdict), causes.taken().size(), 1e6 * before.Rms(),
               1e6 * after.Rms(),
               1e6 * after.u95.norm() / std::sqrt(static_cast<double>(after.off.cols())));
    EXPECT_LE(beyond, 0.0) << seed << ' ' << hidden;
  }
  fmt::print("refused {}, changed {}, rms within U95 {}\n", refused.Text(), changed.Text(),
             rms.Text());
  EXPECT_EQ(rms.met, rms.worlds);
}

}  // namespace corrected_map_test
}  // namespace abbe
