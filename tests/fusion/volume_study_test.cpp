// What is known of a calibration before it is measured, against what the estimator says after.
#include "fusion/volume_study.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "fusion/pose_choice.h"
#include "linkage_world.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {
namespace volume_study_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

simulation::LinkageSimulation World() {
  const auto settings = WorldSettings();
  return {WorldChain(), settings, relm::MakeLinkageModel(settings, relm::ErrorModel::kPivots)};
}

// Data without noise leave the parameters nominal; the covariance that the estimator reports then
// is the inverse of what the candidates say beforehand, by another path through the code.
TEST(VolumeStudy, PredictsTheCovarianceThatTheEstimatorReports) {
  const auto simulation = World();
  auto run = simulation::RunAt(GridPositions({0.025, 0.025, 0.050}, {4, 4, 5}), WorldSettings());
  run.readings.angles = simulation.Readings(run, simulation.Values());
  const auto result =
      simulation::MakeLinkageProblem(simulation, {run}, {.loss = estimation::RobustLoss::None()})
          .Solve();
  const PoseInformation candidates(simulation, run, simulation.Values());
  const Index n = candidates.white.cols();
  ASSERT_EQ(result.covariance.rows(), n);
  const MatrixXd predicted =
      (MatrixXd::Identity(n, n) + candidates.white.transpose() * candidates.white).inverse();
  Eigen::VectorXd prior(n);
  Index at = 0;
  for (const auto& block : simulation.Blocks()) {
    for (const auto& entry : block.entries) {
      if (!entry.held) prior[at++] = entry.prior_sd;
    }
  }
  ASSERT_EQ(at, n);
  const MatrixXd reported =
      prior.cwiseInverse().asDiagonal() * result.covariance * prior.cwiseInverse().asDiagonal();
  // In units of the priors the information has a condition below 1e8: 1e-16 of it.
  EXPECT_LT((reported - predicted).cwiseAbs().maxCoeff(), 1e-6);
}

// At the same number of points a grid over more of the travel knows the travel better and sees no
// fewer combinations.
TEST(VolumeStudy, LargerVolumesKnowTheTravelBetter) {
  const auto rows = StudyVolumes(World(), {Vector3d::Zero(), Vector3d::Constant(0.060)});
  ASSERT_FALSE(rows.empty());
  int compared = 0;
  for (const VolumeRow& small : rows) {
    EXPECT_EQ(small.poses, small.points.prod());
    EXPECT_GT(small.rank, 0);
    for (const VolumeRow& large : rows) {
      if (large.points != small.points || !(large.size.array() > small.size.array()).all())
        continue;
      EXPECT_LT(large.travel_rms, small.travel_rms);
      EXPECT_GE(large.rank, small.rank);
      ++compared;
    }
  }
  EXPECT_GT(compared, 0);
}

}  // namespace volume_study_test
}  // namespace abbe::fusion
