#include "estimation/variance_parts.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kGroups = 12, kEach = 5, kRows = kGroups * kEach;

// One for rows of one group.
MatrixXd SameGroup() {
  MatrixXd same = MatrixXd::Zero(kRows, kRows);
  for (Index g = 0; g < kGroups; ++g) same.block<kEach, kEach>(kEach * g, kEach * g).setOnes();
  return same;
}

VectorXd Drawn(double of_groups) {
  const random::CounterRandom random(1, 2);
  VectorXd y(kRows);
  for (Index i = 0; i < kRows; ++i) {
    y[i] = random.Normal(i) + of_groups * random.Normal(1000 + i / kEach);
  }
  return y;
}

VarianceSizes SizesOf(const VectorXd& y, const MatrixXd& prior) {
  return EstimateVariances(prior, {{MatrixXd::Identity(kRows, kRows)}, {SameGroup()}}, y);
}

// Balanced groups of mean 0: the likeliest sizes in closed form (Searle, Casella, McCulloch,
// Variance components, 1992, 4.8).
TEST(VarianceParts, AreThoseOfBalancedGroups) {
  const VectorXd y = Drawn(2.0);
  const auto groups = y.reshaped(kEach, kGroups);
  const Eigen::RowVectorXd means = groups.colwise().mean();
  const double within = (groups.rowwise() - means).squaredNorm() / (kRows - kGroups);
  const double between = means.squaredNorm() / kGroups - within / kEach;
  const VarianceSizes found = SizesOf(y, MatrixXd::Zero(kRows, kRows));
  EXPECT_NEAR(found.of_parts[0], within, 1e-3 * within);
  EXPECT_NEAR(found.of_parts[1], between, 1e-3 * between);
  const double one = within + kEach * between;  // variance of a sum of a group, over kEach
  const double log_determinant = (kRows - kGroups) * std::log(within) + kGroups * std::log(one);
  EXPECT_NEAR(found.log_likelihood, -0.5 * (kRows + log_determinant), 1e-3);
}

TEST(VarianceParts, ThatAreNotThereFallTowardsZero) {
  VectorXd y = Drawn(0.0);
  for (Index g = 0; g < kGroups; ++g) {  // less alike than by chance
    y.segment<kEach>(kEach * g).array() -= y.segment<kEach>(kEach * g).mean();
  }
  EXPECT_LT(SizesOf(y, MatrixXd::Zero(kRows, kRows)).of_parts[1], 1e-3);
}

// A level of each group that is unknown already leaves nothing to be seen of it.
TEST(VarianceParts, LeaveWhatThePriorExplains) {
  const VectorXd y = Drawn(2.0);
  const VarianceSizes found = SizesOf(y, 1e6 * SameGroup());
  const auto groups = y.reshaped(kEach, kGroups);
  const Eigen::RowVectorXd means = groups.colwise().mean();
  const double within = (groups.rowwise() - means).squaredNorm() / (kRows - kGroups);
  EXPECT_NEAR(found.of_parts[0], within, 1e-3 * within);
}

TEST(VarianceParts, AreNotLessThanTheirLeast) {
  const VarianceSizes found = EstimateVariances(
      MatrixXd::Zero(kRows, kRows), {{MatrixXd::Identity(kRows, kRows), 9.0}}, Drawn(0.0));
  EXPECT_EQ(found.of_parts[0], 9.0);
}

TEST(VarianceParts, RefuseACovarianceThatIsNone) {
  EXPECT_THROW(SizesOf(Drawn(0.0), -1e6 * MatrixXd::Identity(kRows, kRows)), NumericalError);
}

}  // namespace
}  // namespace abbe::estimation
