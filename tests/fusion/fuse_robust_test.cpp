// What may go wrong in a campaign, and what is left out of the fit on purpose: wild readings, long
// recordings, rows held out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "random/counter_random.h"
#include "simulation/linkage/linkage_on_machine.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::fusion {
namespace fuse_robust_test {

using Eigen::Vector3d;
using simulation::SimulatedRun;
using testing::HasSubstr;
using testing::ThrowsMessage;

const FuseOptions kFixed{.choose_smoothness = false};

const Campaign& World() {
  static const Campaign campaign(CampaignMachine(), 5);
  return campaign;
}

std::vector<SimulatedRun> Sweeps() {
  return {World().Sweep('X'), World().Sweep('Y'), World().Sweep('Z')};
}

// The largest difference of two maps, in standard uncertainties of the first.
double Moved(const map::ErrorMap& map, const map::ErrorMap& other) {
  double most = 0.0;
  for (double x = 0.003; x < 0.06; x += 0.009) {
    for (double y = 0.003; y < 0.06; y += 0.009) {
      for (double z = 0.003; z < 0.06; z += 0.009) {
        for (const Vector3d& tool : {Vector3d(0, 0, 0), Vector3d(0.03, -0.02, 0.04)}) {
          const Vector3d off = other.Error({x, y, z}, tool) - map.Error({x, y, z}, tool);
          const Vector3d u = map.StandardUncertainty({x, y, z}, tool);
          most = std::max(most, off.cwiseQuotient(u).cwiseAbs().maxCoeff());
        }
      }
    }
  }
  return most;
}

// Lines to and fro through the volume, some 7000 rows.
recording::Recording LongPath() {
  const auto course = rig::LineCourse(
      rig::GridPlaces(Vector3d::Constant(0.030), Vector3d::Constant(0.058), {2, 6, 6}), 0.04, 0.0,
      1);
  return World().rig.Record(course, {.rate = 125.0, .cap_force = 1e3});
}

simulation::LinkageRun RowsOf(const recording::Recording& path) {
  auto run = simulation::ReadLinkageRun(path, World().linkage);
  run.name = "path";
  return run;
}

SimulatedRun Simulated(const simulation::LinkageRun& run) {
  const simulation::LinkageSimulation nominal(
      World().machine.chain, World().linkage,
      relm::MakeLinkageModel(World().linkage, relm::ErrorModel::kComplete));
  return simulation::SimulateLinkage(World().model, World().reference, nominal, run);
}

std::vector<Eigen::Index> Range(Eigen::Index first, Eigen::Index last) {
  std::vector<Eigen::Index> poses;
  for (Eigen::Index i = first; i < last; ++i) poses.push_back(i);
  return poses;
}

// Cells know a little less than their rows. The difference of an estimate and of one that knows
// more has the variance by which they differ; a tenth of u besides for the losses, of rows here and
// of cells there.
TEST(FuseOfLongRuns, GatheredTheySayWhatTheirRowsSay) {
  const simulation::LinkageRun path = RowsOf(LongPath());
  ASSERT_GT(path.poses(), 5000);
  auto gathered = Sweeps();
  gathered.push_back(World().Length('X'));
  auto by_rows = gathered;
  gathered.push_back(Simulated(path));
  for (Eigen::Index first = 0; first < path.poses(); first += 4000) {
    by_rows.push_back(
        Simulated(Selection(path, Range(first, std::min(first + 4000, path.poses())))));
  }
  const FuseReport from_cells = Fuse(World().machine, gathered, kFixed);
  const FuseReport from_rows = Fuse(World().machine, by_rows, kFixed);
  ASSERT_GT(from_rows.fit.rows, 2 * from_cells.fit.rows);
  constexpr double kLosses = 0.1, kWithin = 4.0;
  EXPECT_NEAR(from_cells.scale.value, from_rows.scale.value, kLosses * from_rows.scale.u);
  for (double x = 0.003; x < 0.06; x += 0.018) {
    for (double y = 0.003; y < 0.06; y += 0.018) {
      for (double z = 0.003; z < 0.06; z += 0.018) {
        const Vector3d at(x, y, z), tool(0.03, -0.02, 0.04);
        const Eigen::Array3d off = from_cells.map.Error(at, tool) - from_rows.map.Error(at, tool);
        const Eigen::Array3d cells = from_cells.map.StandardUncertainty(at, tool);
        const Eigen::Array3d rows = from_rows.map.StandardUncertainty(at, tool);
        const Eigen::Array3d known = (cells.square() - rows.square()).max(0.0);
        const Eigen::Array3d band = (known + (kLosses * rows).square()).sqrt();
        EXPECT_LT((off / band).abs().maxCoeff(), kWithin) << at.transpose();
        EXPECT_LT((cells / rows).maxCoeff(), 1.2) << at.transpose();
      }
    }
  }
  const auto& cells = from_cells.fit.sources[4];
  EXPECT_NEAR(cells.chi_square / cells.redundancy, 1.0, 3.3 * std::sqrt(2.0 / cells.redundancy));
}

// A fit that takes its derivatives at noisy angles shrinks the linkage to shrink the noise: by 3
// poses u^2, here half of u. Two runs with the same noise of opposite sign tell it from the noise.
TEST(FuseOfManyRows, DoesNotShrinkTheLinkageToShrinkItsNoise) {
  auto path = simulation::MeansOfStays(RowsOf(World().LinkageRecording(15)));
  path.samples.setOnes();
  const random::CounterRandom random(5, 0x3AC);
  Eigen::MatrixXd noise(3, path.poses());
  for (Eigen::Index i = 0; i < noise.size(); ++i) {
    noise.reshaped()[i] =
        World().linkage.noise.encoder * random.Normal(static_cast<std::uint64_t>(i));
  }
  double scale[2], u = 0.0, clean = 0.0;
  for (const int sign : {0, 1, -1}) {
    auto run = path;
    run.readings.angles += sign * noise;
    auto runs = Sweeps();
    runs.push_back(Simulated(run));
    const auto report = Fuse(World().machine, runs, kFixed);
    (sign == 0 ? clean : scale[sign > 0 ? 0 : 1]) = report.scale.value;
    u = report.scale.u;
  }
  EXPECT_GT(3.0 * static_cast<double>(path.poses()) * u, 0.15);  // what it would be, over u
  EXPECT_NEAR(0.5 * (scale[0] + scale[1]), clean, 0.03 * u);
}

// Every 250th row is off by a fifth of a millimetre.
TEST(FuseOfLongRuns, WildRowsDoNotMoveTheMap) {
  simulation::LinkageRun path = RowsOf(LongPath());
  auto clean = Sweeps(), wild = clean;
  clean.push_back(Simulated(path));
  for (Eigen::Index i = 0; i < path.poses(); i += 250) path.readings.angles(1, i) += 1e-3;
  wild.push_back(Simulated(path));
  EXPECT_LT(
      Moved(Fuse(World().machine, clean, kFixed).map, Fuse(World().machine, wild, kFixed).map),
      0.5);
}

// One probe, or all of them, in one pass of five; in one of two nobody could say which is wrong.
TEST(FuseOfSweeps, AWildStationDoesNotMoveTheMap) {
  const Campaign world(CampaignMachine({{"passes = 2", "passes = 5"}}), 5);
  const auto clean = world.SweepRecording('X');
  std::vector<SimulatedRun> runs{world.Sweep(clean), world.Sweep('Y'), world.Sweep('Z'),
                                 world.Linkage()};
  const FuseReport right = Fuse(world.machine, runs, kFixed);
  const auto x = clean.At("x_mm"), pass = clean.At("pass"), direction = clean.At("direction");
  for (const bool all : {false, true}) {
    auto recording = clean;
    for (std::size_t row = 0; row < recording.rows(); ++row) {
      if (std::abs(x[row] - 24.0) > 0.1 || pass[row] != 1.0) continue;
      if (!all && direction[row] < 0.0) continue;
      for (auto& column : recording.columns) {
        if (column.name == "probe_a_um" || (all && column.name.starts_with("probe_"))) {
          column.values[row] += 5.0;
        }
      }
    }
    runs[0] = world.Sweep(recording);
    const FuseReport wild = Fuse(world.machine, runs, kFixed);
    // A mean of robust weights still gives way by about a standard deviation of its station.
    EXPECT_LT(Moved(right.map, wild.map), 1.5) << (all ? "a station" : "a dwell");
  }
}

TEST(FuseHoldout, PredictsTheRowsThatItHasNotSeen) {
  auto runs = Sweeps();
  runs.push_back(World().Linkage());
  runs.push_back(World().Length('X'));
  FuseOptions options = kFixed;
  options.holdout = 5;
  const FuseReport report = Fuse(World().machine, runs, options);
  ASSERT_EQ(report.held_out.size(), runs.size());
  for (const HeldOut& run : report.held_out) {
    ASSERT_GT(run.rows, 0) << run.name;
    EXPECT_EQ(run.expected, static_cast<double>(run.rows));
    // Four standard deviations of a chi-square.
    EXPECT_NEAR(run.chi_square / run.expected, 1.0,
                4.0 * std::sqrt(2.0 / static_cast<double>(run.rows)))
        << run.name;
  }
  // Encoders three times as noisy as stated.
  const Campaign noisy(CampaignMachine({{"encoder_urad = 3.0", "encoder_urad = 9.0"}}), 5);
  runs[3] = World().Linkage(noisy.LinkageRecording());
  const FuseReport stated_small = Fuse(World().machine, runs, options);
  EXPECT_GT(stated_small.held_out[3].chi_square, 4.0 * stated_small.held_out[3].expected);
}

TEST(FuseHoldout, RefusesToHoldOutAllOrNothing) {
  for (const int n : {1, 20}) {
    FuseOptions options = kFixed;
    options.holdout = n;
    EXPECT_THAT([&] { Fuse(World().machine, {World().Length('X')}, options); },
                ThrowsMessage<InputError>(HasSubstr(n == 1 ? "leaves nothing" : "of 12 rows")));
  }
}

// The ball sits half a micrometre off in each stay, as the machine file says.
TEST(FuseOfTheBall, KnowsHowItRepeats) {
  const Campaign campaign(
      CampaignMachine({{"encoder_urad = 3.0", "encoder_urad = 3.0\nrepeatability_um = 0.5"}}), 5);
  const FuseReport report = Fuse(campaign.machine, {campaign.Linkage()}, kFixed);
  const auto& linkage = report.fit.sources[0];
  EXPECT_NEAR(linkage.chi_square / linkage.redundancy, 1.0,
              3.3 * std::sqrt(2.0 / linkage.redundancy));
  const FuseReport not_stated =
      Fuse(campaign.machine, {World().Linkage(campaign.LinkageRecording())}, kFixed);
  EXPECT_GT(not_stated.fit.sources[0].chi_square, 1.5 * not_stated.fit.sources[0].redundancy);
}

TEST(FuseOfAnotherChain, IsRefused) {
  const Campaign other(CampaignMachine({{R"(w X Y b Z t\])", "w b X Y Z t]"}}), 5);
  EXPECT_THAT([&] { other.Linkage(World().LinkageRecording()); },
              ThrowsMessage<InputError>(HasSubstr("go different ways")));
}

}  // namespace fuse_robust_test
}  // namespace abbe::fusion
