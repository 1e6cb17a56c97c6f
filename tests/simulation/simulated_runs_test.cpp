// The simulations of all kinds of runs: their derivatives against differences, and their readings
// against the virtual rig.
#include <gtest/gtest.h>

#include <cmath>

#include "random/counter_random.h"
#include "rig/probe_runs.h"
#include "rig/record_plate.h"
#include "simulation/points/plate_simulation.h"
#include "simulation/points/reference_simulation.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::simulation {
namespace simulated_runs_test {

using Eigen::Index;
using Eigen::VectorXd;
using fusion::Campaign;
using fusion::CampaignMachine;

const Campaign& World() {
  static const Campaign campaign(CampaignMachine({{"step_mm = 4.0", "step_mm = 10.0"}}), 3);
  return campaign;
}

VectorXd NominalOf(const SimulatedRun& run) {
  std::vector<double> x;
  for (const auto& block : run.blocks) {
    for (const auto& entry : block.entries) x.push_back(entry.value);
  }
  return Eigen::Map<VectorXd>(x.data(), static_cast<Index>(x.size()));
}

SimulatedRun Reference() {
  const auto course =
      rig::DwellCourse(rig::GridPlaces(Eigen::Vector3d::Constant(0.03), {0.05, 0.05, 0.05},
                                       Eigen::Vector3i::Constant(2)),
                       0.1, 0.02, 1);
  const auto recording = World().rig.Record(course, {.kind = "reference", .rate = 100.0});
  return SimulateReference(World().model, World().reference, 0.3e-6, recording);
}

// Central differences over a step h of each unknown: off by the rounding of the residual over h,
// and by its third derivative, at angles and places that are off by a thousandth.
void ExpectTrueDerivatives(const SimulatedRun& run) {
  const random::CounterRandom random(1, 2);
  VectorXd x = NominalOf(run);
  for (Index i = 0; i < x.size(); ++i) x[i] += 1e-5 * random.Normal(static_cast<std::uint64_t>(i));
  const Index rows = run.residual->Rows();
  VectorXd values(rows), up(rows), down(rows);
  estimation::RowMatrix jacobian(rows, x.size());
  run.residual->Evaluate(x, values, &jacobian);
  run.residual->Evaluate(x, up, nullptr);
  ASSERT_LT((values - up).norm(), 1e-9 * (1.0 + values.norm())) << run.name;
  constexpr double kStep = 1e-6;
  for (Index i = 0; i < x.size(); ++i) {
    VectorXd at = x;
    at[i] = x[i] + kStep;
    run.residual->Evaluate(at, up, nullptr);
    at[i] = x[i] - kStep;
    run.residual->Evaluate(at, down, nullptr);
    const VectorXd slope = (up - down) / (2.0 * kStep);
    const double rounding = 1e-14 * values.cwiseAbs().maxCoeff() / kStep;
    ASSERT_LT((slope - jacobian.col(i)).cwiseAbs().maxCoeff(),
              1e-6 * slope.cwiseAbs().maxCoeff() + 100.0 * rounding + 1e-3)
        << run.name << ", unknown " << i;
  }
}

TEST(SimulatedRuns, HaveTrueDerivatives) {
  ExpectTrueDerivatives(World().Sweep('X'));  // the table moves
  ExpectTrueDerivatives(World().Sweep('Z'));  // the head moves
  ExpectTrueDerivatives(World().Linkage(World().LinkageRecording(2)));
  ExpectTrueDerivatives(World().Length('Y'));
  ExpectTrueDerivatives(Reference());
  for (const PlateSetup& setup : ReadPlate(rig::RecordPlate(World().rig.world(), {.holes = 3}))) {
    ExpectTrueDerivatives(SimulatePlate(World().model, World().reference, setup));
  }
}

// Every stage alone moves the reading by what a hand calculation says.
TEST(SimulatedRuns, SweepFollowsTheHandCalculation) {
  const Campaign plain(
      CampaignMachine({{"step_mm = 4.0", "step_mm = 10.0"}, {"form_nm = 10.0", "form_nm = 0.0"}}),
      3);
  rig::RecordSweepOptions options;
  options.rate = 50.0;
  options.moving = false;
  auto recording = rig::RecordSweep(plain.rig.world(), 'X', plain.channels, options);
  SweepRun sweep = ReadSweepRun(recording, plain.instrument.head, plain.noise);
  for (auto& covariance : sweep.covariance) {
    covariance.setIdentity();  // m^2: the residual is then the reading itself
  }
  const SimulatedRun run = SimulateSweep(plain.model, plain.reference, plain.instrument, sweep);
  const auto change = [&](const std::string& block, int entry, double by) {
    VectorXd x = NominalOf(run), before(run.residual->Rows()), after(run.residual->Rows());
    run.residual->Evaluate(x, before, nullptr);
    Index at = 0;
    for (const auto& each : run.blocks) {
      if (each.name.starts_with(block)) x[at + entry] += by;
      at += each.size();
    }
    run.residual->Evaluate(x, after, nullptr);
    return VectorXd(before - after);  // the change of the simulated reading
  };
  const Index n = sweep.rows();
  // A gain shows in its own probe alone, as the gap of half the range times the change.
  const VectorXd gain = change("probe_gain", 1, 1e-3);
  EXPECT_NEAR(gain.segment(n, n).mean(), 1e-3 * 100e-6, 1e-9);
  EXPECT_EQ(gain.head(n).norm(), 0.0);
  // A target tilted about y by b: its top falls along x. When it moves by d, what stood before the
  // probe by d comes under it: the gap closes by b d.
  const VectorXd tilt = change("target_tilt", 1, 1e-4);
  for (Index row = 0; row < n; ++row) {
    const double d = sweep.position[row] - sweep.position[0];
    EXPECT_NEAR(tilt[row] - tilt[0], -1e-4 * d, 1e-4 * d * 1e-3 + 1e-12) << d;
  }
}

// At each station the gaps follow the steps of the other two axes: by their way, but for what gain
// and tilt are off by.
TEST(SimulatedRuns, GapStepsFollowTheirWay) {
  const auto recording = rig::RecordGapSteps(World().rig.world(), 'X', {});
  const Eigen::Matrix<double, 6, 3> slopes = Eigen::Matrix<double, 6, 3>::Constant(1e-4);
  SweepRun steps = ReadGapSteps(recording, World().noise, slopes);
  const Index n = steps.rows();
  ASSERT_EQ(n, 3 * 9);  // the second axis begins where the first one came back to
  EXPECT_NEAR(steps.steps.row(1).maxCoeff(), 45e-6, 0.5e-6);
  EXPECT_NEAR(steps.steps.row(2).minCoeff(), -45e-6, 0.5e-6);
  for (auto& covariance : steps.covariance) covariance.setIdentity();
  const SimulatedRun run =
      SimulateSweep(World().model, World().reference, World().instrument, steps);
  VectorXd x = NominalOf(run), left(run.residual->Rows()), sloped(run.residual->Rows());
  estimation::RowMatrix jacobian(run.residual->Rows(), x.size());
  run.residual->Evaluate(x, left, &jacobian);
  for (Index slope = x.size() - 18; slope < x.size(); ++slope) {
    x[slope] = 1e-4;
    run.residual->Evaluate(x, sloped, nullptr);
    x[slope] = 0.0;
    EXPECT_LT((sloped - left - 1e-4 * jacobian.col(slope)).cwiseAbs().maxCoeff(), 1e-18);
  }
  EXPECT_NEAR(jacobian.col(x.size() - 18 + 6 + 1).cwiseAbs().maxCoeff(), 45e-6, 1e-6);  // EYY
  for (Index probe = 0; probe < 5; ++probe) {
    for (Index station = 0; station < 3; ++station) {
      const auto own = [&](const VectorXd& values) {
        const VectorXd part = values.segment(9 * station, 9);
        return VectorXd(part.array() - part.mean()).cwiseAbs().maxCoeff();
      };
      EXPECT_GT(own(steps.gap.row(probe).transpose()), 40e-6);
      EXPECT_LT(own(left.segment(probe * n, n)), 0.5e-6);
    }
  }
}

}  // namespace simulated_runs_test
}  // namespace abbe::simulation
