// The joint estimate against the virtual rig, which shares no code with it.
#include "fusion/fuse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fusion/calibrate.h"
#include "simulation/linkage/linkage_on_machine.h"
#include "simulation/points/length_simulation.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::fusion {
namespace fuse_test {

using Eigen::Vector3d;
using simulation::SimulatedRun;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

const FunctionSeen& Seen(const FuseReport& report, const std::string& name) {
  return *std::find_if(report.functions.begin(), report.functions.end(),
                       [&](const FunctionSeen& function) { return function.name == name; });
}

class FuseOfRig : public testing::Test {
 protected:
  static const Campaign& World() {
    static const Campaign campaign(CampaignMachine(), 5);
    return campaign;
  }
  static const std::vector<SimulatedRun>& Sweeps() {
    static const std::vector<SimulatedRun> sweeps{World().Sweep('X'), World().Sweep('Y'),
                                                  World().Sweep('Z')};
    return sweeps;
  }
  static const std::vector<SimulatedRun>& AllRuns() {
    static const std::vector<SimulatedRun> runs = [] {
      std::vector<SimulatedRun> all = Sweeps();
      all.push_back(World().Linkage());
      all.push_back(World().Length('X'));
      return all;
    }();
    return runs;
  }
  static const FuseReport& All() {
    static const FuseReport report = Fuse(World().machine, AllRuns(), {});
    return report;
  }
};

// The rig's noise is what the machine file states, so what is left must be noise of that size: the
// whole simulation is as exact as the rig. 99.9 % band of chi-square, rows as many as stated.
TEST_F(FuseOfRig, LeavesNothingButTheStatedNoise) {
  for (const auto& source : All().fit.sources) {
    if (source.is_prior) continue;
    const double spread = 3.3 * std::sqrt(2.0 / source.redundancy);
    EXPECT_NEAR(source.chi_square / source.redundancy, 1.0, spread) << source.name;
  }
  EXPECT_EQ(All().contradicting, -1);
}

TEST_F(FuseOfRig, FindsTheMapOfTheMachine) {
  double square = 0.0, machine = 0.0;
  int count = 0;
  for (double x = 0.002; x < 0.06; x += 0.008) {
    for (double y = 0.002; y < 0.06; y += 0.008) {
      for (double z = 0.002; z < 0.06; z += 0.008) {
        const Vector3d truth = World().TrueError({x, y, z});
        square += (All().map.Error({x, y, z}, Vector3d::Zero()) - truth).squaredNorm();
        machine += truth.squaredNorm();
        ++count;
      }
    }
  }
  // The stated uncertainty of such a campaign is 0.8 um; one world in a hundred may have twice it.
  EXPECT_LT(std::sqrt(square / count), 1.6e-6);
  EXPECT_GT(std::sqrt(machine / count), 3e-6);  // there was something to find
}

TEST_F(FuseOfRig, ChoosesTheSmoothnessOfThePopulation) {
  // To four standard uncertainties of its logarithm.
  const auto expect_truth = [](const FuseReport& report) {
    const auto seen =
        std::find_if(report.statements.begin(), report.statements.end(),
                     [](const Statement& each) { return each.key == kSmoothnessKey; });
    ASSERT_NE(seen, report.statements.end());
    EXPECT_EQ(seen->seen, report.chosen_smoothness);
    EXPECT_LT(seen->u_log, 0.05);
    EXPECT_NEAR(std::log(seen->seen / 0.015), 0.0, 4.0 * seen->u_log);
  };
  expect_truth(All());
  for (const char* stated : {"smoothness_mm = 7.5", "smoothness_mm = 30.0"}) {
    const settings::Document wrong = CampaignMachine({{"smoothness_mm = 15.0", stated}});
    Campaign mistaken = World();
    mistaken.machine = machine::ReadMachine(wrong.Root());
    mistaken.model = UnknownMachine(mistaken.machine);
    SCOPED_TRACE(stated);
    expect_truth(mistaken.Fused({mistaken.SweepRecording('X'), mistaken.SweepRecording('Y'),
                                 mistaken.SweepRecording('Z')}));
  }
}

TEST_F(FuseOfRig, TellsWhatDeterminedEachError) {
  EXPECT_THAT(Seen(All(), "EBX").determined_by, testing::Contains("sweep"));
  EXPECT_THAT(Seen(All(), "EXX").determined_by, testing::Contains("length"));
  EXPECT_THAT(Seen(All(), "EYY").determined_by, ElementsAre("linkage"));
  // A ball at the reference point does not move when the axis that carries the spindle turns.
  EXPECT_THAT(Seen(All(), "EAZ").determined_by, ElementsAre("sweep"));
  EXPECT_TRUE(All().scale.calibrated);

  const FuseReport sweeps = Fuse(World().machine, Sweeps(), {.choose_smoothness = false});
  EXPECT_THAT(Seen(sweeps, "EXX").determined_by, IsEmpty());
  EXPECT_FALSE(sweeps.scale.calibrated);
  EXPECT_EQ(sweeps.map.Scale(), "prior only");
  // Nothing was seen of it, so it is known as before.
  EXPECT_NEAR(Seen(sweeps, "EXX").u, Seen(sweeps, "EXX").prior, 1e-3 * Seen(sweeps, "EXX").prior);
}

// A gauge that is 50 um too long over 60 mm.
TEST_F(FuseOfRig, NamesAWrongLength) {
  auto recording = World().LengthRecording('X');
  for (auto& column : recording.columns) {
    if (column.name != "length_mm") continue;
    for (double& value : column.values) value *= 1.0 + 50e-6 / 0.06;
  }
  auto runs = AllRuns();
  runs.back() = simulation::SimulateLengths(World().model, World().reference, recording);
  const FuseReport report = Fuse(World().machine, runs, {.choose_smoothness = false});
  ASSERT_EQ(report.contradicting, 4);
  EXPECT_EQ(report.runs[4].name, "length X");
}

// The sweep of Y says that it saw the target as mounted for X and Z, but it was knocked meanwhile.
TEST_F(FuseOfRig, NamesASweepWithAnotherMounting) {
  const Campaign knocked(
      CampaignMachine({{"\\[target\\]", "[rig]\ntarget_tilt_urad = 2000\n[target]"}}), 5);
  auto runs = AllRuns();
  runs[1] = knocked.Sweep('Y');
  const FuseReport report = Fuse(World().machine, runs, {.choose_smoothness = false});
  ASSERT_GE(report.contradicting, 0);
  EXPECT_EQ(report.runs[static_cast<std::size_t>(report.contradicting)].name, "sweep Y");
}

// Calibrated on a machine that is taken as perfect, the linkage learns much of the machine's
// errors, even where these change within 15 mm and the cube is 25 x 25 x 50 mm.
// The form of the target is the same each time. What it adds to a variance stays, but for what the
// prior of the errors takes of it, which is more where there is more noise.
TEST_F(FuseOfRig, KeepsTheFormOfTheTargetHoweverOftenItIsSwept) {
  constexpr std::uint64_t kSweeps = 12;
  const auto fused = [](const Campaign& world, std::uint64_t sweeps) {
    std::vector<SimulatedRun> runs;
    for (std::uint64_t run = 1; run <= sweeps; ++run) {
      auto recording = world.SweepRecording('X', run);
      recording.name = fmt::format("sweep {}", run);
      runs.push_back(world.Sweep(recording));
    }
    return Fuse(world.machine, runs, {.choose_smoothness = false});
  };
  const Campaign flat(CampaignMachine({{"form_nm = 10.0", "form_nm = 0.0"}}), 5);
  const FuseReport one = fused(World(), 1), many = fused(World(), kSweeps),
                   flat_one = fused(flat, 1), flat_many = fused(flat, kSweeps);
  for (const char* name : {"EYX", "EZX", "EAX", "EBX", "ECX"}) {
    const auto by_form = [&](const FuseReport& with, const FuseReport& without) {
      return std::pow(Seen(with, name).u, 2) - std::pow(Seen(without, name).u, 2);
    };
    EXPECT_GT(by_form(many, flat_many), 0.9 * by_form(one, flat_one)) << name;
    EXPECT_LT(Seen(many, name).u, Seen(one, name).u) << name;
  }
}

// The rig shifts and reverses its target: three sweeps must show one form, and tell it from the
// axis.
TEST_F(FuseOfRig, TellsTheFormOfTheTargetWhereItIsShiftedAndReversed) {
  const settings::Document document = CampaignMachine({{"form_nm = 10.0", "form_nm = 200.0"}});
  const Campaign campaign(document, 5);
  const auto swept = [&](const rig::Mounting& mounting, std::uint64_t run) {
    const rig::World world(rig::ReadRigSettings(document.Root()), 5, {}, mounting);
    auto recording = rig::RecordSweep(
        world, 'X', campaign.channels,
        {.rate = 50.0,
         .moving = false,
         .run = run,
         .mounting = fmt::format("{}", mounting.number),
         .more = fmt::format("head = \"0deg\"\ntarget_shift_mm = {}\ntarget_reversed = {}\n",
                             1e3 * mounting.target_shift, mounting.target_reversed)});
    recording.name = fmt::format("sweep {}", run);
    return campaign.Sweep(recording);
  };
  const auto fused = [&](const std::vector<SimulatedRun>& runs) {
    return Fuse(campaign.machine, runs, {.choose_smoothness = false});
  };
  const FuseReport same = fused({swept({}, 1), swept({}, 2), swept({}, 3)}),
                   moved = fused({swept({}, 1), swept({.number = 1, .target_shift = 20e-3}, 2),
                                  swept({.number = 2, .target_reversed = true}, 3)});
  for (const auto& source : moved.fit.sources) {
    if (source.is_prior) continue;
    EXPECT_LT(source.chi_square / source.redundancy, 1.0 + 3.3 * std::sqrt(2.0 / source.redundancy))
        << source.name;
  }
  for (const char* name : {"EYX", "EZX", "EBX", "ECX"}) {
    EXPECT_LT(Seen(moved, name).u, 0.6 * Seen(same, name).u) << name;
  }
}

TEST_F(FuseOfRig, ShowsThatALinkageAloneSwallowsTheMachine) {
  const auto course = rig::DwellCourse(
      rig::GridPlaces(Vector3d::Constant(0.030), {0.025, 0.025, 0.050}, {5, 5, 7}), 0.1, 0.1, 1);
  const auto recording = World().rig.Record(course, {.rate = 100.0});
  const auto run = simulation::MeansOfStays(simulation::ReadLinkageRun(recording, World().linkage));
  const CalibrationReport alone =
      Calibrate(World().machine.chain, World().linkage, {run}, {.folds = 0});
  Eigen::Matrix3Xd errors(3, run.poses());
  for (Eigen::Index i = 0; i < run.poses(); ++i)
    errors.col(i) = World().TrueError(run.commanded.col(i));
  errors.colwise() -= errors.rowwise().mean();
  const double machine = errors.colwise().norm().norm() / std::sqrt(run.poses());
  EXPECT_LT(alone.after.rms, 0.7 * machine);
  EXPECT_GT(alone.after.rms, 0.3e-6);  // the noise of its encoders, 3 urad at 120 mm, stays
}

TEST_F(FuseOfRig, RefusesNoRunsAndPlacesOutside) {
  EXPECT_THAT([] { Fuse(World().machine, {}, {}); },
              ThrowsMessage<InputError>(HasSubstr("name at least one")));
  machine::Machine rougher = World().machine;
  rougher.population.smoothness = 0.005;
  EXPECT_THAT([&] { Fuse(rougher, Sweeps(), {}); },
              ThrowsMessage<InputError>(HasSubstr("another machine model")));
  auto recording = World().LengthRecording('Y');
  recording.columns[2].values[3] = 80.0;
  EXPECT_THAT([&] { simulation::SimulateLengths(World().model, World().reference, recording); },
              ThrowsMessage<InputError>(HasSubstr("length Y: row 4: y = 80.0000 mm lies outside")));
}

}  // namespace fuse_test
}  // namespace abbe::fusion
