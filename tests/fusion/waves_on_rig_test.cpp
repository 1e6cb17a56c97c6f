// A screw with a wave of a few millimetres, seen by a linkage at places that are 12 mm apart: is the
// map right between them, and does it know how wrong it may be?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "random/counter_random.h"
#include "rig/hidden_effect.h"
#include "tests/fusion/rig_campaign.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::fusion {
namespace waves_on_rig_test {

using Eigen::Vector3d;

constexpr double kCoverage = 1.96, kLow = 0.75;  // of three machines; 95 % is stated
constexpr double kGain = 0.6;                    // of the error without waves, at most
constexpr int kPlaces = 300;
// mm: none with the same phase at all planes of the places, which are 14 mm apart: that is a scale.
const std::vector<std::string> kPitches{"4.3", "5.2", "6.1"};

struct World {
  explicit World(std::uint64_t seed, const std::string& pitch)
      : document(CampaignMachine()), campaign(document, seed) {
    hidden = {rig::ParseHidden(
        fmt::format("leadscrew-cyclic:object=Y:amplitude_um=4:pitch_mm={}", pitch), seed, {})};
    campaign.rig = rig::LinkageRig(rig::World(rig::ReadRigSettings(document.Root()), seed, hidden),
                                   rig::Linkage(rig::ReadLinkage(document.Root()), seed));
  }

  // Up to a millimetre off the planes of a grid.
  recording::Recording Places() const {
    const random::CounterRandom draw(campaign.rig.world().seed(), 5);
    auto places = rig::GridPlaces(Vector3d::Constant(0.030), Vector3d::Constant(0.056),
                                  Eigen::Vector3i::Constant(5));
    std::uint64_t number = 0;
    for (Vector3d& place : places) {
      for (double& each : place) each += draw.Uniform(number++, -1e-3, 1e-3);
    }
    auto recording =
        campaign.rig.Record(rig::DwellCourse(places, 0.1, 0.1, 1), {.rate = 100.0, .run = 1});
    recording.name = "places";
    return recording;
  }
  // With the wave, which moves Y.
  Vector3d TrueError(const Vector3d& axes) const {
    const rig::HiddenEffect& screw = hidden.front();
    const double pitch = screw.At("pitch_mm"), phase = screw.At("phase_rad");
    Vector3d there = axes;
    there.y() += screw.At("amplitude_um") * std::sin(2.0 * M_PI * axes.y() / pitch + phase);
    const auto& chain = campaign.machine.chain;
    return campaign.TrueError(there) + relm::NominalTip(chain, there) -
           relm::NominalTip(chain, axes);
  }

  const settings::Document document;
  Campaign campaign;
  rig::HiddenEffects hidden;
};

struct Held {
  double square = 0.0, stated = 0.0, inside = 0.0;  // of the error, of u; the share inside U95
};

// Against the truth at places all over the volume, along Y.
Held Judge(const World& world, const FuseReport& report) {
  const random::CounterRandom draw(world.campaign.rig.world().seed(), 6);
  Held held;
  std::uint64_t number = 0;
  for (int i = 0; i < kPlaces; ++i) {
    Vector3d at;
    for (double& each : at) each = draw.Uniform(number++, 0.0, 0.06);
    const double off = report.map.Error(at, Vector3d::Zero()).y() - world.TrueError(at).y();
    const double u = report.map.StandardUncertainty(at, Vector3d::Zero()).y();
    held.square += off * off / kPlaces;
    held.stated += u * u / kPlaces;
    if (std::abs(off) < kCoverage * u) held.inside += 1.0 / kPlaces;
  }
  return held;
}

TEST(WavesOnRig, AreInTheMapAndInItsUncertainty) {
  const Seeds seeds = SeedsFromEnvironment();
  Mean with, without, inside;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    SCOPED_TRACE(seed);
    const World world(seed, kPitches.at(seed % kPitches.size()));
    std::vector<recording::Recording> runs{world.Places(), world.campaign.LengthRecording('X')};
    for (const char axis : {'X', 'Y', 'Z'}) runs.push_back(world.campaign.SweepRecording(axis));
    const FuseReport report = world.campaign.Fused(runs);
    const Held waves = Judge(world, report);
    std::vector<simulation::SimulatedRun> simulated;
    for (const auto& run : runs) simulated.push_back(world.campaign.Simulated(run));
    const Held smooth = Judge(world, Fuse(world.campaign.machine, simulated, {}));
    fmt::print(
        "seed {}: {:.2f} um (u {:.2f} um, wave {:.2f} um), {:.0f} % inside U95; smooth: {:.2f} um (u {:.2f} um), {:.0f} %\n",
        seed, 1e6 * std::sqrt(waves.square), 1e6 * std::sqrt(waves.stated),
        1e6 * report.scatter.front().held, 100.0 * waves.inside, 1e6 * std::sqrt(smooth.square),
        1e6 * std::sqrt(smooth.stated), 100.0 * smooth.inside);
    with.Add(waves.square);
    without.Add(smooth.square);
    inside.Add(waves.inside);
    EXPECT_EQ(report.scatter.front().axis, 1);
    EXPECT_EQ(report.contradicting, -1);
  }
  EXPECT_GT(inside.mean(), kLow);
  EXPECT_LT(std::sqrt(with.mean()), kGain * std::sqrt(without.mean()));
}

}  // namespace waves_on_rig_test
}  // namespace abbe::fusion
