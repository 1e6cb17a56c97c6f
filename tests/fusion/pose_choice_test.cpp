// The exchange against designs that theory knows, and the study of volumes against the estimator.
#include "fusion/pose_choice.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "linkage_world.h"

namespace abbe::fusion {
namespace pose_choice_test {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

constexpr double kStrong = 1e4;  // times the prior: leaves 1e-8 of it in the determinant

simulation::LinkageSimulation World() {
  const auto settings = WorldSettings();
  return {WorldChain(), settings, relm::MakeLinkageModel(settings, relm::ErrorModel::kPivots)};
}

PoseInformation Of(const MatrixXd& white) {
  const auto simulation = World();
  auto run = simulation::RunAt(GridPositions({0.02, 0.02, 0.02}, {2, 2, 2}), WorldSettings());
  run.readings.angles = simulation.Readings(run, simulation.Values());
  PoseInformation candidates(simulation, run, simulation.Values());
  candidates.white = candidates.tip = white;
  return candidates;
}

PoseInformation Polynomial(const std::vector<double>& at, int degree) {
  MatrixXd white = MatrixXd::Zero(3 * static_cast<Index>(at.size()), degree + 1);
  for (std::size_t i = 0; i < at.size(); ++i) {
    for (int power = 0; power <= degree; ++power) {
      white(3 * static_cast<Index>(i), power) = kStrong * std::pow(at[i], power);
    }
  }
  return Of(white);
}

PoseInformation Random(std::uint64_t seed, Index poses, Index parameters) {
  const random::CounterRandom random(seed, 0);
  MatrixXd white(3 * poses, parameters);
  std::uint64_t draw = 0;
  for (double& entry : white.reshaped()) entry = 3.0 * random.Normal(draw++);
  return Of(white);
}

// log det(1 + sum J'J) written out, without the updates under test.
double PlainLogDeterminant(const PoseInformation& candidates, const std::vector<Index>& poses) {
  const Index n = candidates.white.cols();
  MatrixXd information = MatrixXd::Identity(n, n);
  for (const Index pose : poses) {
    const MatrixXd rows = candidates.white.middleRows(3 * pose, 3);
    information += rows.transpose() * rows;
  }
  return std::log(information.determinant());
}

std::vector<Index> Sorted(std::vector<Index> poses) {
  std::sort(poses.begin(), poses.end());
  return poses;
}

// Fedorov (1972): the D-optimal design of a polynomial of degree d on [-1, 1] sits on the roots of
// (1 - x^2) P_d'(x); for the cubic these are +-1 and +-1/sqrt(5), for the parabola -1, 0 and 1.
TEST(PoseChoice, FindsTheKnownDesignOfACubic) {
  const double inner = 1.0 / std::sqrt(5.0);
  const std::vector<double> at{-1.0, -0.8, -0.6, -inner, -0.2, 0.0, 0.2, inner, 0.6, 0.8, 1.0};
  EXPECT_EQ(Sorted(ChoosePoses(Polynomial(at, 3), 4).poses), (std::vector<Index>{0, 3, 7, 10}));
}

TEST(PoseChoice, FindsTheKnownDesignOfAParabola) {
  const std::vector<double> at{-1.0, -0.7, -0.3, 0.0, 0.4, 0.9, 1.0};
  EXPECT_EQ(Sorted(ChoosePoses(Polynomial(at, 2), 3).poses), (std::vector<Index>{0, 3, 6}));
}

TEST(PoseChoice, StopsWhereNoSingleExchangeGains) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PoseInformation candidates = Random(seed, 24, 7);
    const PoseChoice choice = ChoosePoses(candidates, 6);
    const double reached = PlainLogDeterminant(candidates, choice.poses);
    EXPECT_NEAR(choice.log_determinant, reached, 1e-9 * reached);  // rounding of some 50 updates
    for (std::size_t out = 0; out < choice.poses.size(); ++out) {
      for (Index in = 0; in < candidates.poses(); ++in) {
        if (std::ranges::find(choice.poses, in) != choice.poses.end()) continue;
        std::vector<Index> other = choice.poses;
        other[out] = in;
        EXPECT_LE(PlainLogDeterminant(candidates, other), reached + 1e-8) << "seed " << seed;
      }
    }
  }
}

// sum over all rows of J C J' = trace(J'J (1 + J'J)^-1) = sum of s^2 / (1 + s^2) over the singular
// values s: with all poses chosen.
TEST(PoseChoice, TellsTheUncertaintyOfTheTips) {
  const PoseInformation candidates = Random(5, 30, 6);
  const Eigen::ArrayXd s2 = candidates.white.jacobiSvd().singularValues().array().square();
  const double expected = std::sqrt((s2 / (1.0 + s2)).sum() / 30.0);
  const PoseChoice all = ChoosePoses(candidates, 30);
  EXPECT_NEAR(all.tip_rms, expected, 1e-12);
  EXPECT_NEAR(TipUncertainty(candidates, all.poses), expected, 1e-12);
  EXPECT_EQ(all.exchanges, 0);
}

TEST(PoseChoice, MorePosesKnowMoreUntilTheyAreEnough) {
  PoseInformation candidates = Random(8, 120, 6);
  candidates.reading_noise = std::sqrt(3.0);  // the rows are whitened: 1 in each direction
  const auto rows = HowManyPoses(candidates, {2, 4, 8, 16, 60, 200});
  ASSERT_EQ(rows.size(), 5U);  // 200 are not there
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_LT(rows[i].tip_rms, rows[i - 1].tip_rms);
  EXPECT_FALSE(rows.front().enough);
  EXPECT_TRUE(rows.back().enough);
}

// Over the cube of Boelens (2006), chosen poses leave the parameters a smaller volume than as many
// taken evenly.
TEST(PoseChoice, BeatsEvenPosesOfTheLinkage) {
  const auto simulation = World();
  auto run = simulation::RunAt(GridPositions({0.025, 0.025, 0.050}, {7, 7, 12}), WorldSettings());
  run.readings.angles = simulation.Readings(run, simulation.Values());
  const PoseInformation candidates(simulation, run, simulation.Values());
  std::vector<Index> even;
  for (Index i = 0; i < 49; ++i) even.push_back(12 * i + 6);
  EXPECT_GT(ChoosePoses(candidates, 49).log_determinant,
            PlainLogDeterminant(candidates, even) + 1.0);
}

TEST(PoseChoice, RefusesMorePosesThanThereAre) {
  const PoseInformation candidates = Random(1, 6, 3);
  EXPECT_THROW(ChoosePoses(candidates, 7), InputError);
  EXPECT_THROW(ChoosePoses(candidates, 0), InputError);
}

}  // namespace pose_choice_test
}  // namespace abbe::fusion
