// Expected evidence against the normal densities of the data themselves, where no coefficient, no
// score and no projection exists: r ~ N(0, I + sum of p^2 c c').
#include "diagnosis/expected_odds.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "random/counter_random.h"

namespace abbe::diagnosis {
namespace expected_odds_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRounding = 1e-10;

simulation::Cause CauseOf(const VectorXd& plausible) {
  simulation::Cause cause;
  cause.plausible = plausible;
  return cause;
}

MatrixXd Columns(Eigen::Index count, double phase) {
  MatrixXd columns(7, count);
  for (Eigen::Index i = 0; i < columns.size(); ++i) {
    columns.reshaped()[i] = 1.3 * std::sin(1.7 * static_cast<double>(i) + phase);
  }
  return columns;
}

// Mean of log N(r; of, K) - log N(r; 0, I) over r ~ N(m, I).
double MeanLogRatio(const MatrixXd& K, const VectorXd& of, const VectorXd& m) {
  const auto density = [&](const MatrixXd& covariance, const VectorXd& mean) {
    const VectorXd off = m - mean;
    return -0.5 * (std::log(covariance.determinant()) + covariance.inverse().trace() +
                   off.dot(covariance.inverse() * off));
  };
  const MatrixXd I = MatrixXd::Identity(m.size(), m.size());
  return density(K, of) - density(I, VectorXd::Zero(m.size()));
}

MatrixXd CovarianceWith(const MatrixXd& columns, const VectorXd& plausible) {
  const MatrixXd scaled = columns * plausible.asDiagonal();
  return MatrixXd::Identity(columns.rows(), columns.rows()) + scaled * scaled.transpose();
}

class TwoRivals : public testing::Test {
 protected:
  const VectorXd plausible_a_ = Eigen::Vector2d(0.5, 2.0), plausible_b_ = VectorXd::Ones(1);
  const MatrixXd a_ = Columns(2, 0.3), b_ = Columns(1, 1.1);
  const VectorXd coefficients_a_ = Eigen::Vector2d(0.7, -1.1),
                 coefficients_b_ = VectorXd::Constant(1, 1.6);
  simulation::Cause cause_a_ = CauseOf(plausible_a_), cause_b_ = CauseOf(plausible_b_);

  MatrixXd Information() const {
    MatrixXd both(a_.rows(), 3);
    both << a_, b_;
    return both.transpose() * both;
  }
  std::vector<RivalWorld> Rivals(double now_a = 0.5) const {
    return {{{&cause_a_, "X", {}}, coefficients_a_, now_a},
            {{&cause_b_, "X", {}}, coefficients_b_, 1.0 - now_a}};
  }
};

TEST_F(TwoRivals, HaveTheEvidenceOfTheirDensities) {
  const VectorXd m = a_ * coefficients_a_, none = VectorXd::Zero(m.size());
  const VectorXd evidence = ExpectedEvidence(Information(), Rivals(), 0);
  EXPECT_NEAR(evidence[0], MeanLogRatio(CovarianceWith(a_, plausible_a_), none, m), kRounding);
  EXPECT_NEAR(evidence[1], MeanLogRatio(CovarianceWith(b_, plausible_b_), none, m), kRounding);
}

TEST_F(TwoRivals, OneOfThemThereOrNot) {
  cause_b_.amount = simulation::Amount::kBinary;
  const VectorXd m = a_ * coefficients_a_;
  const MatrixXd I = MatrixXd::Identity(m.size(), m.size());
  EXPECT_NEAR(ExpectedEvidence(Information(), Rivals(), 0)[1], MeanLogRatio(I, b_.col(0), m),
              kRounding);
}

TEST_F(TwoRivals, OthersAreIntegratedOut) {
  const MatrixXd S = FreeOfOthers(Information(), 2, plausible_b_);
  const MatrixXd direct = a_.transpose() * CovarianceWith(b_, plausible_b_).inverse() * a_;
  EXPECT_TRUE(S.isApprox(direct, kRounding));
}

TEST_F(TwoRivals, StayAsTheyAreWhereNothingIsAdded) {
  const MatrixXd S = Information();
  EXPECT_NEAR(ExpectedProbability(S, S, Rivals(0.7)), 0.7 * 0.7 + 0.3 * 0.3, kRounding);
}

// Draws of the data of one run, and the odds by their densities.
TEST_F(TwoRivals, HaveTheirProbabilityInTheMeanOfManyRuns) {
  constexpr int kRuns = 40000;
  cause_a_ = CauseOf(VectorXd::Ones(1));
  cause_a_.amount = cause_b_.amount = simulation::Amount::kBinary;
  const VectorXd a = 0.6 * a_.col(0), b = 0.6 * b_.col(0);
  MatrixXd both(a.size(), 2);
  both << a, b;
  const VectorXd there = VectorXd::Ones(1);
  for (const double now : {0.5, 0.8}) {
    const std::vector<RivalWorld> rivals{{{&cause_a_, "X", {}}, there, now},
                                         {{&cause_b_, "X", {}}, there, 1.0 - now}};
    const double expected =
        ExpectedProbability(MatrixXd::Zero(2, 2), both.transpose() * both, rivals);
    const random::CounterRandom random(5, 1);
    double sum = 0.0, squares = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      const auto first = static_cast<std::uint64_t>(run) * 16;
      const bool is_a = random.Uniform(first) < now;
      VectorXd r = is_a ? a : b;
      for (Eigen::Index i = 0; i < r.size(); ++i) {
        r[i] += random.Normal(first + 1 + static_cast<std::uint64_t>(i));
      }
      const double of_a = now * std::exp(-0.5 * (r - a).squaredNorm());
      const double of_b = (1.0 - now) * std::exp(-0.5 * (r - b).squaredNorm());
      const double right = (is_a ? of_a : of_b) / (of_a + of_b);
      sum += right;
      squares += right * right;
    }
    const double mean = sum / kRuns;
    const double u = std::sqrt((squares / kRuns - mean * mean) / kRuns);
    EXPECT_NEAR(expected, mean, 4.0 * u);
    EXPECT_LT(expected, 0.95);
  }
}

TEST_F(TwoRivals, AreToldApartByColumnsOfTheirOwn) {
  MatrixXd more = Information();
  more(0, 0) += 100.0;
  more(1, 1) += 100.0;
  more(2, 2) += 100.0;
  EXPECT_GT(ExpectedProbability(Information(), more, Rivals()), 0.999);
}

}  // namespace expected_odds_test
}  // namespace abbe::diagnosis
