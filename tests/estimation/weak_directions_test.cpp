#include "estimation/weak_directions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "linear_case.h"

namespace abbe::estimation {
namespace weak_directions_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::HasSubstr;
using Held = WeakDirection::Held;

// Rows that see a + b, c and d, but never a - b.
MatrixXd OnlyTheSum(Eigen::Index rows) {
  MatrixXd a = RandomMatrix(rows, 4, 7);
  a.col(1) = a.col(0);
  return a;
}

Result Solve(const MatrixXd& a, ParameterBlock block, double sigma,
             const SolveOptions& options = {}) {
  Problem problem;
  const BlockId id = problem.Add(std::move(block));
  problem.Add(problem.AddSource("data"), Linear(a, VectorXd::Zero(a.rows())), {id}, sigma);
  return problem.Solve(options);
}

TEST(WeakDirections, WithoutPriorTheSumIsSeenAndTheDifferenceIsNamed) {
  const MatrixXd a = OnlyTheSum(50);
  const Result result = Solve(a, Block("arm", {"a", "b", "c", "d"}), 1e-6);
  EXPECT_EQ(result.status, Result::Status::kUndetermined);
  ASSERT_EQ(result.weak_directions.size(), 1u);
  EXPECT_EQ(result.weak_directions[0].words, "0.71 arm.a - 0.71 arm.b");
  EXPECT_EQ(result.weak_directions[0].held, Held::kByNothing);
  EXPECT_THAT(result.WhyNotUsable(), HasSubstr("0.71 arm.a - 0.71 arm.b"));
  EXPECT_TRUE(std::isinf(result.condition));
  // Nothing is silently regularised: a and b are open, c and d are as if the sum were one
  // parameter.
  EXPECT_TRUE(std::isinf(result.Uncertainty("arm.a")));
  EXPECT_TRUE(std::isinf(result.Uncertainty("arm.b")));
  EXPECT_TRUE(std::isnan(result.Covariance("arm", "arm")(0, 1)));
  EXPECT_TRUE(std::isnan(result.Covariance("arm", "arm")(0, 2)));
  MatrixXd merged(50, 3);
  merged << a.col(0), a.col(2), a.col(3);
  const MatrixXd covariance = (merged.transpose() * merged).inverse() * 1e-12;
  EXPECT_NEAR(result.Uncertainty("arm.c") / std::sqrt(covariance(1, 1)), 1.0, 1e-6);
  EXPECT_NEAR(result.Covariance("arm", "arm")(2, 3) / covariance(1, 2), 1.0, 1e-4);
  EXPECT_EQ(result.Seen("arm.a"), SeenBy::kNothing);
  EXPECT_EQ(result.Seen("arm.c"), SeenBy::kData);
  EXPECT_EQ(result.freedom, 50 - 3);
  EXPECT_NEAR(result.redundancy, 50 - 3, 1e-6);
}

TEST(WeakDirections, WithPriorTheDifferenceKeepsIt) {
  const Result result = Solve(OnlyTheSum(50), Block("arm", {"a", "b", "c", "d"}, 1e-3), 1e-6);
  ASSERT_TRUE(result.Usable());
  ASSERT_EQ(result.weak_directions.size(), 1u);
  EXPECT_EQ(result.weak_directions[0].words, "0.71 arm.a - 0.71 arm.b");
  EXPECT_EQ(result.weak_directions[0].held, Held::kByPrior);
  EXPECT_NEAR(result.weak_directions[0].ratio, 1.0, 1e-6);
  // a = ((a + b) + (a - b)) / 2 with a - b of the prior's sqrt(2) 1e-3.
  EXPECT_NEAR(result.Uncertainty("arm.a"), 1e-3 / std::sqrt(2.0), 1e-8);
  EXPECT_NEAR(result.Correlation("arm.a", "arm.b"), -1.0, 1e-5);
}

// Data that see the sum alone: c is held by its prior, a - b by nothing, and that is all that is named.
TEST(WeakDirections, WhatNothingDeterminesIsNamedThoughTheOthersAreNotAskedFor) {
  MatrixXd a = OnlyTheSum(50);
  a.col(2).setZero();
  ParameterBlock block = Block("arm", {"a", "b", "c", "d"});
  block["c"].prior_sd = 1e-3;
  const Result all = Solve(a, block, 1e-6), few = Solve(a, block, 1e-6, {.weak_directions = false});
  EXPECT_EQ(all.weak_directions.size(), 2u);
  ASSERT_EQ(few.weak_directions.size(), 1u);
  EXPECT_EQ(few.weak_directions[0].words, "0.71 arm.a - 0.71 arm.b");
  EXPECT_EQ(few.weak_directions[0].held, Held::kByNothing);
  EXPECT_EQ(few.WhyNotUsable(), all.WhyNotUsable());
  EXPECT_EQ(few.Uncertainty("arm.c"), all.Uncertainty("arm.c"));
}

TEST(WeakDirections, NothingIsInventedOnAWellPosedProblem) {
  for (const double prior : {kNoPrior, 1e-3}) {
    const Result result =
        Solve(RandomMatrix(50, 4, 7), Block("arm", {"a", "b", "c", "d"}, prior), 1e-6);
    EXPECT_TRUE(result.Usable());
    EXPECT_TRUE(result.weak_directions.empty());
    EXPECT_THAT(result.Report(), HasSubstr("the data see every combination"));
  }
}

TEST(WeakDirections, TheThresholdIsTiedToTheNoise) {
  // One reading of one parameter: its information is (prior / noise)^2.
  for (const double noise : {0.9, 1.1}) {
    const Result result = Solve(MatrixXd::Ones(1, 1), Block("p", {"x"}, 1.0), noise);
    EXPECT_EQ(result.weak_directions.size(), noise > 1.0 ? 1u : 0u) << noise;
    EXPECT_EQ(result.Seen("p.x"), noise > 1.0 ? SeenBy::kPrior : SeenBy::kData);
    if (noise > 1.0) {  // to the 1e-12 that the reference allows for rounding
      EXPECT_NEAR(result.weak_directions[0].information, 1.0 / 1.21, 1e-11);
      EXPECT_NEAR(result.weak_directions[0].ratio, std::sqrt(1.21 / 2.21), 1e-11);
    }
  }
}

TEST(WeakDirections, AToleranceDecidesWhereThereIsNoPrior) {
  ParameterBlock block = Block("p", {"x", "y"});
  block["x"].tolerance = 0.5;
  block["y"].tolerance = 2.0;
  const Result result = Solve(MatrixXd::Identity(2, 2), block, 1.0);
  ASSERT_TRUE(result.Usable());  // determined, though not to the tolerance
  ASSERT_EQ(result.weak_directions.size(), 1u);
  EXPECT_EQ(result.weak_directions[0].words, "1.00 p.x");
  EXPECT_EQ(result.weak_directions[0].held, Held::kByTolerance);
  EXPECT_EQ(result.Seen("p.x"), SeenBy::kNothing);
  EXPECT_EQ(result.Seen("p.y"), SeenBy::kData);
  EXPECT_NEAR(result.Uncertainty("p.x"), 1.0, 1e-12);  // the tolerance does not pull
}

TEST(WeakDirections, SeveralAreToldApartInWords) {
  // Unseen: a - b, c + d, and e alone; the eigenvectors of the common eigenvalue 0 are any mixture.
  MatrixXd a = RandomMatrix(60, 6, 11);
  a.col(1) = a.col(0);
  a.col(3) = -a.col(2);
  a.col(4).setZero();
  const Result result = Solve(a, Block("p", {"a", "b", "c", "d", "e", "f"}, 1.0), 1e-4);
  std::vector<std::string> words;
  for (const auto& weak : result.weak_directions) words.push_back(weak.words);
  EXPECT_THAT(words, testing::UnorderedElementsAre("0.71 p.a - 0.71 p.b", "0.71 p.c + 0.71 p.d",
                                                   "1.00 p.e"));
}

TEST(WeakDirections, MixedUnitsDoNotHideOne) {
  // A length in m and an angle in rad whose effects differ by 1e6 in size.
  MatrixXd a = RandomMatrix(40, 3, 13);
  a.col(1) = 1e6 * a.col(0);
  ParameterBlock block = Block("p", {"length", "angle", "other"});
  block["length"].prior_sd = 1e-3;
  block["angle"].prior_sd = 1e-9;
  const Result result = Solve(a, block, 1e-7);
  ASSERT_EQ(result.weak_directions.size(), 1u);
  EXPECT_EQ(result.weak_directions[0].words, "0.71 p.length - 0.71 p.angle");
}

TEST(WeakDirections, AParameterThatNoResidualMentionsIsNamed) {
  Problem problem;
  const BlockId used = problem.Add(Block("used", {"x"})), idle = problem.Add(Block("idle", {"y"}));
  (void)idle;
  problem.Add(problem.AddSource("s"), Linear(MatrixXd::Ones(3, 1), VectorXd::Ones(3)), {used}, 1.0);
  const Result result = problem.Solve();
  EXPECT_FALSE(result.Usable());
  EXPECT_THAT(result.WhyNotUsable(), HasSubstr("1.00 idle.y"));
  EXPECT_NEAR(result.Value("used.x"), 1.0, 1e-12);
  EXPECT_NEAR(result.Uncertainty("used.x"), 1.0 / std::sqrt(3.0), 1e-9);
}

TEST(WeakDirections, TheReportSaysAllOfIt) {
  const Result result = Solve(OnlyTheSum(50), Block("arm", {"a", "b", "c", "d"}, 1e-3), 1e-6);
  const std::string report = result.Report();
  EXPECT_THAT(report, HasSubstr("redundancy"));
  EXPECT_THAT(report, HasSubstr("0.71 arm.a - 0.71 arm.b: stays at 1.00 of its prior"));
  EXPECT_THAT(report, HasSubstr("arm.c"));
  EXPECT_THAT(report, HasSubstr("um"));
}

TEST(WeakDirections, WordsHoldTheLargestOnly) {
  VectorXd c(5);
  c << 0.05, -0.8, 0.02, 0.59, 0.001;
  EXPECT_EQ(InWords(c, {"a", "b", "c", "d", "e"}), "-0.80 b + 0.59 d and 2 smaller");
}

}  // namespace weak_directions_test
}  // namespace abbe::estimation
