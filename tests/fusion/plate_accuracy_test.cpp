// Are the 21 errors of a plate as uncertain as they say? One world of the virtual rig a seed, which
// shares no code with the simulation; the five set-ups of rig/record_plate.h.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "fusion/interpolators.h"
#include "fusion/plate_diagonals.h"
#include "fusion/specimen_check.h"
#include "random/counter_random.h"
#include "rig/record_plate.h"
#include "tests/fusion/rig_campaign.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::fusion {
namespace plate_accuracy_test {

using Eigen::VectorXd;
using simulation::PlateSetup;

constexpr double kCoverage = 1.96;
constexpr int kMotionErrors = machine::kAxes * machine::kMotions;

double TrueError(const rig::World& world, int error, double position) {
  if (error < kMotionErrors) {
    return world.ErrorsOf(error / machine::kMotions, position)[error % machine::kMotions];
  }
  const auto& square = world.squareness();
  return std::array{square.a0z, square.b0z,
                    square.c0y}[static_cast<std::size_t>(error - kMotionErrors)];
}

struct Measured {
  std::vector<PlateSetup> setups;
  FuseReport report;
};

Measured Measure(const Campaign& campaign, const rig::PlateProgram& program = {}) {
  auto setups = simulation::ReadPlate(rig::RecordPlate(campaign.rig.world(), program));
  std::vector<simulation::SimulatedRun> runs;
  for (const PlateSetup& setup : setups) {
    runs.push_back(simulation::SimulatePlate(campaign.model, campaign.reference, setup));
  }
  FuseReport report = Fuse(campaign.machine, runs, {.choose_smoothness = false});
  return {std::move(setups), std::move(report)};
}

TEST(PlateAccuracy, StatesTrueUncertainties) {
  const settings::Document document = CampaignMachine();
  Pulls one;  // a seed: one error at one place, so that they are independent
  std::array<Pulls, map::kErrors> each;
  std::array<Pulls, 3> diagonals;
  const Seeds seeds = SeedsFromEnvironment();
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const Campaign campaign(document, seed);
    const Measured measured = Measure(campaign);
    const random::CounterRandom random(seed, 0x51A);
    const int chosen = static_cast<int>(map::kErrors * random.Uniform(0));
    for (int error = 0; error < map::kErrors; ++error) {
      const double at = random.Uniform(1 + static_cast<std::uint64_t>(error), 0.005, 0.06);
      const auto curve = measured.report.map.CurveOf(error, VectorXd::Constant(1, at));
      const double off = curve.value[0] - TrueError(campaign.rig.world(), error, at);
      each[static_cast<std::size_t>(error)].Add(off, curve.u[0], kCoverage);
      if (error == chosen) one.Add(off, curve.u[0], kCoverage);
    }
    const auto by = SquarenessByDiagonals(measured.report, campaign.reference, measured.setups);
    for (std::size_t k = 0; k < by.size(); ++k) {
      const double truth = TrueError(campaign.rig.world(), kMotionErrors + static_cast<int>(k), 0);
      diagonals[k].Add(by[k].value - truth, by[k].u, kCoverage);
      const double u = measured.report.fit.Uncertainty(
          "squareness." + map::ErrorName(kMotionErrors + static_cast<int>(k)));
      EXPECT_GE(by[k].u, u);  // the fit uses every hole
    }
  }
  fmt::print("{:<7}{:>12}{:>12}{:>10}\n", "error", "mean pull", "variance", "in U95");
  for (int error = 0; error < map::kErrors; ++error) {
    const Pulls& pulls = each[static_cast<std::size_t>(error)];
    fmt::print("{:<7}{:>12.3f}{:>12.3f}{:>9.1f}%\n", map::ErrorName(error), pulls.pull.mean(),
               pulls.square.mean(), 100.0 * pulls.inside.mean());
  }
  // Three times four bounds, of which none should be missed.
  constexpr double k999 = 3.29;
  for (std::size_t k = 0; k < diagonals.size(); ++k) {
    const Pulls& pulls = diagonals[k];
    fmt::print("{:<7}{:>12.3f}{:>12.3f}{:>9.1f}%  by diagonals\n",
               map::ErrorName(kMotionErrors + static_cast<int>(k)), pulls.pull.mean(),
               pulls.square.mean(), 100.0 * pulls.inside.mean());
    pulls.ExpectTrueUncertainties(k999);
  }
  one.ExpectTrueUncertainties();
}

// The recording states a third of the probing's noise, or of the plate's form: the set-ups show it,
// and none of them is blamed.
TEST(PlateAccuracy, OfAPlateThatIsNotAsItsHeaderSays) {
  struct Row {
    const char* name;
    double probing, form;  // over what is stated
  };
  constexpr std::uint64_t kSeeds = 10;
  constexpr double kIndependent = 4.0;  // errors of a machine, in their coverage
  for (const Row& row : {Row{"probing x 3", 3.0, 1.0}, Row{"form x 3", 1.0, 3.0}}) {
    SCOPED_TRACE(row.name);
    Mean inside, diagonals;
    for (std::uint64_t seed = 201; seed < 201 + kSeeds; ++seed) {
      const Campaign campaign(CampaignMachine(), seed);
      auto setups = simulation::ReadPlate(rig::RecordPlate(campaign.rig.world(), {}));
      std::vector<simulation::SimulatedRun> runs;
      for (PlateSetup& setup : setups) {
        setup.u_probing /= row.probing;
        setup.u_form /= row.form;
        runs.push_back(simulation::SimulatePlate(campaign.model, campaign.reference, setup));
      }
      const FuseReport report = Fuse(campaign.machine, runs, {});
      EXPECT_EQ(report.contradicting, -1);
      for (const double noise : report.noise) EXPECT_EQ(noise != 1.0, row.probing != 1.0);
      for (const Statement& line : report.statements) {
        EXPECT_EQ(line.Refuted(), line.key == "u_plate_um" && row.form != 1.0) << line.key;
      }
      const auto covered = [](double off, double u) { return std::abs(off) < kCoverage * u; };
      for (int error = 0; error < map::kErrors; ++error) {
        const auto curve = report.map.CurveOf(error, VectorXd::Constant(1, 0.03));
        const double truth = TrueError(campaign.rig.world(), error, 0.03);
        inside.Add(covered(curve.value[0] - truth, curve.u[0]));
      }
      const auto by = SquarenessByDiagonals(report, campaign.reference, setups);
      for (int k = 0; k < 3; ++k) {
        const auto& [value, u, count] = by[static_cast<std::size_t>(k)];
        const double truth = TrueError(campaign.rig.world(), kMotionErrors + k, 0.0);
        diagonals.Add(covered(value - truth, u));
      }
    }
    fmt::print("{:<12}{:>8.1f}% in U95, by diagonals {:.1f}%\n", row.name, 100.0 * inside.mean(),
               100.0 * diagonals.mean());
    const auto least = [](double count) { return 0.95 - k99 * std::sqrt(0.95 * 0.05 / count); };
    EXPECT_GT(inside.mean(), least(kIndependent * kSeeds));
    EXPECT_GT(diagonals.mean(), least(diagonals.count));
  }
}

class PlateOfRig : public testing::Test {
 protected:
  static const Campaign& World() {
    static const Campaign campaign(CampaignMachine(), 5);
    return campaign;
  }
  static const Measured& All() {
    static const Measured measured = Measure(World());
    return measured;
  }
};

// The data know more of every one of the 21 than the tolerances do.
TEST_F(PlateOfRig, FiveSetupsDetermineAll21Errors) {
  for (const FunctionSeen& seen : All().report.functions) {
    EXPECT_THAT(seen.determined_by, testing::ElementsAre("plate")) << seen.name;
  }
  EXPECT_TRUE(All().report.scale.calibrated);
  EXPECT_EQ(All().report.contradicting, -1);
}

TEST_F(PlateOfRig, OneSetupLeavesTheThirdAxisToThePrior) {
  const auto program = rig::PlateProgram{.setups = {rig::FiveSetups().front()}};
  const FuseReport report = Measure(World(), program).report;
  for (const FunctionSeen& seen : report.functions) {
    if (!seen.name.ends_with("Z")) continue;
    EXPECT_THAT(seen.determined_by, testing::IsEmpty()) << seen.name;
  }
  EXPECT_THAT(report.functions[0].determined_by, testing::ElementsAre("plate"));
}

TEST_F(PlateOfRig, ASetupThatMovedIsNamed) {
  auto recording = rig::RecordPlate(World().rig.world(), {});
  // Half of the third set-up was measured after the plate had slipped by 50 um.
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (recording.At("setup")[row] != 3.0 || recording.At("hole")[row] < 25.0) continue;
    recording.columns[1].values[row] += 0.05;
  }
  std::vector<simulation::SimulatedRun> runs;
  for (const PlateSetup& setup : simulation::ReadPlate(recording)) {
    runs.push_back(simulation::SimulatePlate(World().model, World().reference, setup));
  }
  const FuseReport report = Fuse(World().machine, runs, {.choose_smoothness = false});
  ASSERT_EQ(report.contradicting, 2);
}

// The document's specimen: measured by the machine as it is, then corrected.
TEST_F(PlateOfRig, ASpecimenIsMeasuredBetterAfterwards) {
  double before = 0.0, after = 0.0;
  for (const char axis : {'X', 'Y', 'Z'}) {
    for (const auto& each : CheckSpecimen(All().report.map, World().LengthRecording(axis))) {
      before += std::pow(each.before - each.length, 2);
      after += std::pow(each.after - each.length, 2);
      // The specimen has its own: 0.1 um and 2 ppm.
      const double u = std::hypot(each.u, 0.1e-6 * std::sqrt(2.0), 2e-6 * each.length);
      EXPECT_LT(std::abs(each.after - each.length), 4.0 * u) << axis << each.row;
    }
  }
  EXPECT_LT(std::sqrt(after), std::sqrt(before) / 2.0);
}

// What is left of the holes where each plate is laid by least squares on axes that do not err: rms
// in the plane. The axes read where the table went, so against the plate where they carry it.
double OfRigidPlates(const std::vector<PlateSetup>& setups) {
  double squares = 0.0, holes = 0.0;
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const auto [u, v] = rig::FiveSetups()[i].directions;
    Eigen::Matrix2Xd seen(2, setups[i].points.count());
    seen.row(0) = (u == 2 ? 1.0 : -1.0) * setups[i].points.axes.row(u);
    seen.row(1) = (v == 2 ? 1.0 : -1.0) * setups[i].points.axes.row(v);
    const Eigen::Matrix2Xd stated = setups[i].certificate;
    const Eigen::Matrix2Xd from = stated.colwise() - stated.rowwise().mean();
    const Eigen::Matrix2Xd to = seen.colwise() - seen.rowwise().mean();
    const double along = from.cwiseProduct(to).sum();
    const double across = from.row(0).dot(to.row(1)) - from.row(1).dot(to.row(0));
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(std::atan2(across, along)).matrix();
    squares += (to - turn * from).squaredNorm();
    holes += static_cast<double>(seen.cols());
  }
  return std::sqrt(squares / holes);
}

// The B-spline predicts holes as well as they can be known: their form, the probing, and the fit.
// The networks, which know of each function no more than 1 um rms, still know most of the machine.
TEST_F(PlateOfRig, BSplinesPredictHolesThatTheyHaveNotSeen) {
  const auto checks = CompareInterpolators(World().machine, 0.015, All().setups, 4);
  ASSERT_EQ(checks.size(), 3u);
  for (const auto& check : checks) {
    fmt::print("{:<20} held out {:.3f} um, at the stations {:.3f} um, {} neurons, {} cycles\n",
               check.name, 1e6 * check.held_out, 1e6 * check.learning.rms, check.learning.neurons,
               check.learning.cycles);
    EXPECT_GT(check.held_out, std::sqrt(2.0) * 0.2e-6) << check.name;
  }
  EXPECT_LT(checks[0].held_out, 1.5 * std::sqrt(2.0) * std::hypot(0.5e-6, 0.2e-6));
  const double unknown = OfRigidPlates(All().setups);
  fmt::print("{:<20} leaves {:.3f} um\n", "rigid plates", 1e6 * unknown);
  for (const auto& check : checks) EXPECT_LT(check.held_out, 0.6 * unknown) << check.name;
}

}  // namespace plate_accuracy_test
}  // namespace abbe::fusion
