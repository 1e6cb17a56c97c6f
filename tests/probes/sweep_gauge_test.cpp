#include "probes/sweep_gauge.h"

#include <gtest/gtest.h>

namespace abbe::probes {
namespace sweep_gauge_test {

constexpr double kRounding = 1e-12;  // values of order 1, sums of 8

Eigen::VectorXd Stations() { return Eigen::Vector4d(0.0, 1.0, 2.5, 6.0); }

TEST(SweepGauge, AnglesStartAtZeroAndKeepTheirReversal) {
  const SweepGauge gauge(Stations(), 2);
  Eigen::VectorXd values(8);
  values << 5.0, 4.0, 7.0, 6.5, 1.0, 2.0, 3.0, 3.0;
  const Eigen::VectorXd fixed = gauge.Apply(SweepGauge::Kind::kFirstStation, values);
  EXPECT_NEAR(fixed[0] + fixed[1], 0.0, kRounding);
  for (int i = 0; i < 8; i += 2) {
    EXPECT_NEAR(fixed[i] - fixed[i + 1], values[i] - values[i + 1], kRounding);
  }
  const Eigen::VectorXd shifted = values.array() + 17.0;
  EXPECT_TRUE(gauge.Apply(SweepGauge::Kind::kFirstStation, shifted).isApprox(fixed, kRounding));
}

TEST(SweepGauge, ALineVanishesAndTheSlopeIsItsSlope) {
  const SweepGauge gauge(Stations(), 2);
  Eigen::VectorXd line(8);
  for (int i = 0; i < 8; ++i) line[i] = 3.0 - 0.25 * Stations()[i / 2];
  EXPECT_NEAR(gauge.Apply(SweepGauge::Kind::kLine, line).norm(), 0.0, kRounding);
  EXPECT_NEAR(gauge.slope_weights().dot(line), -0.25, kRounding);
}

// G V G^T by the definition: V = sum of outer products, each of which is gauged by itself.
TEST(SweepGauge, TheCovarianceIsThatOfGaugedValues) {
  const SweepGauge gauge(Stations(), 2);
  const Eigen::MatrixXd draws = Eigen::MatrixXd::Random(8, 5);
  for (const auto kind : {SweepGauge::Kind::kFirstStation, SweepGauge::Kind::kLine}) {
    const Eigen::MatrixXd fixed = gauge.Apply(kind, draws);
    EXPECT_TRUE(gauge.Covariance(kind, draws * draws.transpose())
                    .isApprox(fixed * fixed.transpose(), 1e-10));
  }
}

}  // namespace sweep_gauge_test
}  // namespace abbe::probes
