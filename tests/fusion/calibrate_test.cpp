// Calibration against a world written out by hand: recovery, refusals, outliers, both forms.
#include "fusion/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "fusion/calibration_file.h"
#include "linkage_world.h"
#include "random/counter_random.h"

namespace abbe::fusion {
namespace calibrate_test {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using relm::ErrorModel;
using simulation::LinkageRun;
using ::testing::HasSubstr;

const Vector3d kCube(0.025, 0.025, 0.050);

Matrix3Xd Truth(const LinkageRun& run) {
  Matrix3Xd truth = run.commanded;
  truth.topRows<2>() *= -1.0;
  return truth;
}

// Ball positions of another run by the calibration, against where the machine truly stands.
Distances Against(const CalibrationReport& report, const relm::LinkageSettings& settings,
                  const LinkageRun& run) {
  const CalibratedLinkage linkage(settings, report.calibration);
  return DistancesOf(linkage.Tips(run.readings) - Truth(run));
}

// The check that the RELM paper plans: angles by the inverse equations, calibrate, recover.
TEST(Calibrate, RecoversAnErroneousLinkageFromExactAngles) {
  auto settings = WorldSettings();
  settings.noise = {.encoder = 1e-9, .reference = 1e-10, .machine = 1e-10, .repeatability = 0.0};
  const LinkageWorld world = LinkageWorld::Draw(1, false);
  const auto grid = WorldRun(world, settings, GridPositions({0.06, 0.06, 0.06}, {4, 4, 4}), 0, 1);
  const auto other = WorldRun(world, settings, RandomPositions({0.06, 0.06, 0.06}, 50, 2), 0, 1);
  const auto report = Calibrate(WorldChain(), settings, {grid}, {.model = ErrorModel::kPivots});
  EXPECT_GT(report.before.rms, 10e-6);
  // The priors pull by (stated noise / prior)^2 of the parameters' errors: below a picometre.
  EXPECT_LT(Against(report, settings, other).max, 1e-11);
  EXPECT_NEAR(report.fit.Value("link.link_1"), world.link_1, 1e-6);
}

TEST(Calibrate, ReachesTheNoiseWithEncoderErrors) {
  const auto settings = WorldSettings();
  const LinkageWorld world = LinkageWorld::Draw(3, true);
  const auto grid = WorldRun(world, settings, GridPositions({0.06, 0.06, 0.06}, {6, 6, 6}), 1, 3);
  const auto other = WorldRun(world, settings, RandomPositions({0.06, 0.06, 0.06}, 200, 4), 0, 4);
  const auto report = Calibrate(WorldChain(), settings, {grid}, {});
  EXPECT_GT(report.before.rms, 50e-6);
  EXPECT_LT(Against(report, settings, other).rms, 0.5e-6);
  EXPECT_LT(report.held_out.rms, 1.5e-6);  // with the noise of the readings: 3 urad at 150 mm
  EXPECT_LT(report.excess, 1.2);
  EXPECT_TRUE(report.outliers.size() <= 3);  // of 648 rows, 4 standard deviations: 0.04 expected
  EXPECT_EQ(report.seen.rank + static_cast<Eigen::Index>(report.seen.unseen.size()),
            report.seen.parameters);
  EXPECT_GT(report.seen.unseen.size(), 0U);
}

// Nothing may move: there is no spectrum of what the poses tell, and no crash.
TEST(Calibrate, TakesAMachineFileWithoutAnyTolerance) {
  auto settings = WorldSettings();
  settings.tolerance = {};
  const LinkageWorld world = LinkageWorld::Draw(1, false);
  const auto grid = WorldRun(world, settings, GridPositions(kCube, {3, 3, 3}), 0, 1);
  try {
    const auto report = Calibrate(WorldChain(), settings, {grid}, {});
    EXPECT_EQ(report.seen.rank, 0);
    EXPECT_EQ(report.seen.singular_values.size(), 0);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("tolerance"));
  }
}

// Unknown base position: the tips move together, differences stay.
TEST(Calibrate, DisplacementFormKnowsNoBase) {
  const auto settings = WorldSettings();
  LinkageWorld world = LinkageWorld::Draw(5, false);
  world.base += Vector3d(0.004, -0.003, 0.005);  // ten times the tolerance
  const auto grid = WorldRun(world, settings, GridPositions(kCube, {5, 5, 5}), 1, 5);
  EXPECT_THROW(Calibrate(WorldChain(), settings, {grid}, {.model = ErrorModel::kPivots}),
               InputError);
  const auto report = Calibrate(WorldChain(), settings, {grid},
                                {.model = ErrorModel::kPivots, .problem = {.displacement = true}});
  EXPECT_LT(report.held_out.rms, 1.5e-6);
  const auto other = WorldRun(world, settings, RandomPositions(kCube, 100, 6), 0, 6);
  EXPECT_LT(Against(report, settings, other).rms, 0.6e-6);
  // A base without a prior goes into the file and comes back.
  const auto file = std::filesystem::path(testing::TempDir()) / "abbe_displacement.toml";
  WriteCalibration(report.calibration, file);
  const Calibration back = ReadCalibration(file, settings);
  std::filesystem::remove(file);
  ASSERT_EQ(back.blocks.size(), report.calibration.blocks.size());
  EXPECT_EQ(back.blocks[0].entries[0].prior_sd, estimation::kNoPrior);
  EXPECT_NEAR(back.blocks[0].entries[0].value, report.calibration.blocks[0].entries[0].value,
              1e-15);
}

TEST(Calibrate, OutlierIsNamedAndDoesNotPull) {
  const auto settings = WorldSettings();
  const LinkageWorld world = LinkageWorld::Draw(7, false);
  auto grid = WorldRun(world, settings, GridPositions(kCube, {6, 6, 6}), 1, 7);
  const auto other = WorldRun(world, settings, RandomPositions(kCube, 100, 8), 0, 8);
  const auto clean = Calibrate(WorldChain(), settings, {grid}, {.model = ErrorModel::kPivots});
  grid.readings.angles(1, 100) += 500e-6;  // some 80 um at the ball
  const auto report = Calibrate(WorldChain(), settings, {grid}, {.model = ErrorModel::kPivots});
  ASSERT_FALSE(report.outliers.empty());
  EXPECT_EQ(report.outliers.front().pose, 100);
  EXPECT_LT(Against(report, settings, other).rms, Against(clean, settings, other).rms + 0.2e-6);
}

// A reference that wanders by 3 um over an hour, or is three times as noisy as stated: differences of
// ball positions, which a circle shows, are as certain as is said.
TEST(Calibrate, CountsTheNoiseThatIsThere) {
  constexpr int kWorlds = 24;
  const auto settings = WorldSettings();
  const auto mean_square = [&](double wander, double noise) {
    double squares = 0.0;
    for (int seed = 0; seed < kWorlds; ++seed) {
      const LinkageWorld world = LinkageWorld::Draw(20 + seed, false);
      auto grid = WorldRun(world, settings, GridPositions({0.06, 0.06, 0.06}, {6, 6, 6}), 1, seed);
      grid.time.setLinSpaced(grid.poses(), 0.0, 3600.0);
      const random::CounterRandom random(seed, 0xD21F7);
      Vector3d off = Vector3d::Zero();
      std::uint64_t draw = 0;
      for (Index pose = 0; pose < grid.poses(); ++pose) {
        for (double& each : off) {
          each += wander / std::sqrt(grid.poses()) * random.Normal(draw++);
        }
        grid.reference.col(pose) += off;
        for (int i = 0; i < 3; ++i) grid.reference(i, pose) += noise * random.Normal(draw++);
      }
      const auto report =
          Calibrate(WorldChain(), settings, {grid}, {.model = ErrorModel::kPivots, .folds = 0});
      EXPECT_EQ(report.noise.front().memory.has_value(), wander > 0.0);
      const auto other = WorldRun(world, settings, RandomPositions(kCube, 40, 30 + seed), 0, 4);
      const CalibratedLinkage linkage(settings, report.calibration);
      Matrix3Xd off_by = linkage.Tips(other.readings) - Truth(other);
      off_by.colwise() -= off_by.rowwise().mean().eval();
      double variance = 0.0;
      for (const auto& error : linkage.IndependentErrors({&other.readings}, {""})) {
        Matrix3Xd shift = error.front();
        shift.colwise() -= shift.rowwise().mean().eval();
        variance += shift.squaredNorm();
      }
      squares += off_by.squaredNorm() / variance / kWorlds;
    }
    return squares;
  };
  EXPECT_LT(mean_square(3e-6, 0.0), 1.7);
  EXPECT_LT(mean_square(0.0, 5e-6), 1.7);
  EXPECT_LT(mean_square(0.0, 0.0), 1.7);
}

TEST(Calibrate, TwoMountingsShareTheLinkage) {
  const auto settings = WorldSettings();
  LinkageWorld world = LinkageWorld::Draw(9, false);
  auto first = WorldRun(world, settings, GridPositions(kCube, {4, 4, 4}), 1, 9);
  world.base += Vector3d(0.3e-3, 0.2e-3, -0.4e-3);
  auto second = WorldRun(world, settings, GridPositions(kCube, {4, 4, 4}), 1, 10);
  second.mounting = "second";
  const auto report =
      Calibrate(WorldChain(), settings, {first, second}, {.model = ErrorModel::kPivots});
  const Vector3d moved =
      report.fit.Block("base second").Values() - report.fit.Block("base").Values();
  EXPECT_NEAR(moved.x(), 0.3e-3, 3e-6);  // three times what 64 poses leave
  EXPECT_NEAR(moved.y(), 0.2e-3, 3e-6);
  EXPECT_NEAR(moved.z(), -0.4e-3, 3e-6);
  EXPECT_LT(report.excess, 1.2);
}

// What a person reads when something is wrong.
class Refusal : public ::testing::Test {
 protected:
  std::string Message(const LinkageRun& run) {
    try {
      Calibrate(WorldChain(), settings_, {run}, {.model = ErrorModel::kPivots});
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was thrown";
  }
  LinkageRun Grid() const {
    return WorldRun(world_, settings_, GridPositions(kCube, {4, 4, 4}), 1, 11);
  }
  relm::LinkageSettings settings_ = WorldSettings();
  LinkageWorld world_ = LinkageWorld::Draw(11, false);
};

TEST_F(Refusal, TooFewPoses) {
  EXPECT_THAT(Message(simulation::Selection(Grid(), {0, 5, 9, 20, 40})),
              HasSubstr("5 poses give 15 numbers for 17 parameters; record at least 17 poses"));
}
TEST_F(Refusal, AllPosesEqual) {
  EXPECT_THAT(Message(simulation::Selection(Grid(), std::vector<Eigen::Index>(30, 7))),
              HasSubstr("of one place; spread them"));
}
TEST_F(Refusal, CollinearPoses) {
  Matrix3Xd line(3, 30);
  for (int i = 0; i < 30; ++i) line.col(i) = Vector3d(0.001 * i, 0.002 * i, 0.001 * i);
  EXPECT_THAT(Message(WorldRun(world_, settings_, line, 0, 1)), HasSubstr("stand on one line"));
}
TEST_F(Refusal, SwappedEncoders) {
  auto run = Grid();
  run.readings.angles.row(0).swap(run.readings.angles.row(1));
  EXPECT_THAT(Message(run), HasSubstr("the encoders of pivot_1 and pivot_2 are swapped"));
}
TEST_F(Refusal, WrongCountsPerTurn) {
  auto run = Grid();
  run.readings.angles.row(1) *= 1.048576;  // 2^20 taken for a million
  EXPECT_THAT(Message(run), HasSubstr("pivot_2 turns 0.95"));
}
TEST_F(Refusal, ReversedEncoder) {
  auto run = Grid();
  run.readings.angles.row(2) *= -1.0;
  EXPECT_THAT(Message(run), HasSubstr("pivot_3 counts in the other sense"));
}
TEST_F(Refusal, ContradictoryPrior) {
  world_.link_2 += 0.002;  // twenty times the tolerance
  EXPECT_THAT(
      Message(WorldRun(world_, settings_, GridPositions({0.06, 0.06, 0.06}, {5, 5, 5}), 1, 12)),
      HasSubstr("the data contradict the prior"));
}

}  // namespace calibrate_test
}  // namespace abbe::fusion
