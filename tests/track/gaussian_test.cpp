// The square-root filter against the textbook's equations in covariance form, and its marginal
// likelihood against the density of the readings.
#include "track/gaussian.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::track {
namespace gaussian_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRounding = 1e-9;

MatrixXd Drawn(std::uint64_t stream, int rows, int columns) {
  const random::CounterRandom random(5, stream);
  MatrixXd drawn(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      drawn(i, j) = random.Normal(static_cast<std::uint64_t>(100 * i + j));
    }
  }
  return drawn;
}

struct Case {
  MatrixXd P = Drawn(1, 5, 7) * Drawn(1, 5, 7).transpose();
  VectorXd mean = Drawn(2, 5, 1);
  MatrixXd H = Drawn(3, 3, 2);
  MatrixXd R = Drawn(4, 3, 4) * Drawn(4, 3, 4).transpose();
  VectorXd z = Drawn(5, 3, 1);
  std::vector<int> entries{3, 1};

  LinearTest Test() const {
    const MatrixXd weight = R.inverse();
    return {entries, H.transpose() * weight * H, H.transpose() * weight * z};
  }
  MatrixXd WholeH() const {
    MatrixXd whole = MatrixXd::Zero(3, 5);
    whole.col(3) = H.col(0);
    whole.col(1) = H.col(1);
    return whole;
  }
};

TEST(Gaussian, UpdatesAsKalmanDoes) {
  const Case c;
  Gaussian state = MakeGaussian(c.mean, c.P);
  EXPECT_LT((state.Covariance() - c.P).norm(), kRounding);
  Measure(c.Test(), state);
  const MatrixXd H = c.WholeH(), S = H * c.P * H.transpose() + c.R;
  const MatrixXd K = c.P * H.transpose() * S.inverse();
  EXPECT_LT((state.mean - (c.mean + K * (c.z - H * c.mean))).norm(), kRounding);
  EXPECT_LT((state.Covariance() - (c.P - K * H * c.P)).norm(), kRounding);
}

TEST(Gaussian, LikelihoodDiffersBetweenStatesAsTheDensityDoes) {
  const Case c;
  const auto density = [&](const VectorXd& mean, const MatrixXd& P) {
    const MatrixXd H = c.WholeH(), S = H * P * H.transpose() + c.R;
    const VectorXd off = c.z - H * mean;
    return -0.5 * (off.dot(S.inverse() * off) + std::log(S.determinant()));
  };
  Gaussian one = MakeGaussian(c.mean, c.P);
  Gaussian other = MakeGaussian(2.0 * c.mean, 3.0 * c.P);
  const double difference = Measure(c.Test(), one) - Measure(c.Test(), other);
  EXPECT_NEAR(difference, density(c.mean, c.P) - density(2.0 * c.mean, 3.0 * c.P), kRounding);
}

TEST(Gaussian, RootOfASumHasItsCovariance) {
  const MatrixXd A = Drawn(6, 4, 4), B = Drawn(7, 4, 2);
  const MatrixXd root = RootOfSum(A, B);
  EXPECT_LT((root * root.transpose() - A * A.transpose() - B * B.transpose()).norm(), kRounding);
}

TEST(Gaussian, TakesASingularCovarianceAndRefusesANegativeOne) {
  const VectorXd v = Drawn(8, 4, 1);
  EXPECT_LT((RootOf(v * v.transpose()) * RootOf(v * v.transpose()).transpose() - v * v.transpose())
                .norm(),
            1e-7);
  MatrixXd negative = MatrixXd::Identity(2, 2);
  negative(0, 1) = negative(1, 0) = 1.5;
  EXPECT_THROW(RootOf(negative), InputError);
}

TEST(Gaussian, AgreementIsUniformWhereTheStateIsTrue) {
  // Readings drawn from what the state expects: p below 0.1 in a tenth of the cases.
  const Case c;
  const MatrixXd H = c.WholeH(), S = H * c.P * H.transpose() + c.R;
  const MatrixXd root = S.llt().matrixL();
  const Gaussian state = MakeGaussian(c.mean, c.P);
  constexpr int kDraws = 2000;
  int low = 0, directions = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Case drawn = c;
    drawn.z = H * c.mean + root * Drawn(100 + static_cast<std::uint64_t>(draw), 3, 1);
    const Agreement agreement = AgreementOf(drawn.Test(), state);
    directions = agreement.directions;
    if (agreement.probability < 0.1) ++low;
  }
  EXPECT_GT(directions, 0);
  EXPECT_NEAR(low / static_cast<double>(kDraws), 0.1, 4.0 * std::sqrt(0.09 / kDraws));
}

}  // namespace gaussian_test
}  // namespace abbe::track
