#include "geometry/b_spline_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>

#include "failure/failure.h"

namespace abbe::geometry {
namespace b_spline_fit_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();

struct Points {
  Eigen::VectorXd x, y;
};

// Stations of a 60 mm sweep (m) with a bow, a line and a ripple that the spline cannot follow, of
// size 1.
Points Stations(int n = 61) {
  Points points{Eigen::VectorXd::LinSpaced(n, 0.0, 0.06), Eigen::VectorXd(n)};
  for (int k = 0; k < n; ++k) {
    const double u = points.x[k] / 0.06;
    points.y[k] = 0.7 + 2.0 * u - 3.0 * u * u + 0.1 * std::sin(40 * u);
  }
  return points;
}

const BSplineBasis kBasis = BSplineBasis::Uniform(3, 0.0, 0.06, 10);

// The integral of f over [0, 0.06] by Simpson's rule on 6000 panels: for cubics on spans of 0.06/7
// that panels straddle, an error below 1e-9 of the integrand.
template <typename F>
double Simpson(const F& f) {
  constexpr int kPanels = 6000;
  double sum = 0;
  for (int i = 0; i <= kPanels; ++i) {
    sum += (i == 0 || i == kPanels ? 1 : i % 2 == 1 ? 4 : 2) * f(0.06 * i / kPanels);
  }
  return sum * 0.06 / kPanels / 3;
}

TEST(BSplineFit, RecoversASplineFromItsValues) {
  const Eigen::VectorXd c{{1, -2, 3, 0.5, 0, 2, -1, -1, 4, 2}};
  const BSpline truth(kBasis, c);
  Points points = Stations();
  for (int k = 0; k < 61; ++k) points.y[k] = truth.Value(points.x[k]);
  const BSplineFit fit = FitBSpline(kBasis, points.x, points.y);
  // Condition of a cubic basis is about 10, 61 rows.
  EXPECT_LT((fit.spline.coefficients() - c).norm(), 1000 * kEps);
  EXPECT_LT(fit.residual_rms, 100 * kEps);
  EXPECT_NEAR(fit.effective_parameters, 10, 1000 * kEps);
}

TEST(BSplineFit, AgreesWithTheNormalEquationsWeightedAndSmoothed) {
  const Points points = Stations();
  Eigen::VectorXd weights(61);
  for (int k = 0; k < 61; ++k) weights[k] = 1 + 0.5 * std::cos(k);
  const double smoothness = 1e-6;
  const auto fit =
      FitBSpline(kBasis, points.x, points.y, {.weights = weights, .smoothness = smoothness});
  Eigen::MatrixXd B(61, 10);
  for (int k = 0; k < 61; ++k) B.row(k) = kBasis.Row(points.x[k]);
  const Eigen::MatrixXd W = weights.asDiagonal();
  const Eigen::MatrixXd N = B.transpose() * W * B + smoothness * SmoothnessMatrix(kBasis);
  const Eigen::MatrixXd inverse = N.inverse();
  const Eigen::VectorXd c = inverse * B.transpose() * W * points.y;
  const double rounding = 1e4 * kEps;  // condition of N, some hundreds, on coefficients of size 1
  EXPECT_LT((fit.spline.coefficients() - c).norm(), rounding);
  EXPECT_LT((fit.covariance - inverse * B.transpose() * W * B * inverse).norm(), rounding);
  EXPECT_NEAR(fit.effective_parameters, (inverse * B.transpose() * W * B).trace(), rounding);
  EXPECT_NEAR(fit.residual_rms, std::sqrt((points.y - B * c).squaredNorm() / 61), rounding);
}

TEST(BSplineFit, StandardUncertaintyIsTheSpreadOverTheRedundancy) {
  const Points points = Stations();
  const auto fit = FitBSpline(kBasis, points.x, points.y);
  Eigen::MatrixXd B(61, 10);
  for (int k = 0; k < 61; ++k) B.row(k) = kBasis.Row(points.x[k]);
  const double variance = 61 * fit.residual_rms * fit.residual_rms / (61 - 10);
  const Eigen::RowVectorXd row = kBasis.Row(0.02);
  const double u = std::sqrt(variance * row.dot((B.transpose() * B).inverse() * row.transpose()));
  EXPECT_NEAR(fit.StandardUncertainty(0.02), u, 1e4 * kEps * u);
}

TEST(BSplineFit, SmoothnessMatrixIsTheIntegralOfTheSquaredSecondDerivative) {
  const Eigen::VectorXd c{{1, -2, 3, 0.5, 0, 2, -1, -1, 4, 2}};
  const BSpline spline(kBasis, c);
  const double oracle = Simpson([&](double x) { return std::pow(spline.Value(x, 2), 2); });
  // s'' has kinks inside Simpson's panels: relative error below (panel / span)^2.
  EXPECT_NEAR(c.dot(SmoothnessMatrix(kBasis) * c), oracle, 2e-6 * oracle);
}

TEST(BSplineFit, StrongSmoothnessEndsInTheRegressionLine) {
  const Points points = Stations();
  const auto fit = FitBSpline(kBasis, points.x, points.y, {.smoothness = 1e3});
  Eigen::MatrixXd A(61, 2);
  A.col(0).setOnes();
  A.col(1) = points.x;
  const Eigen::VectorXd line = A.householderQr().solve(points.y);
  EXPECT_NEAR(fit.effective_parameters, 2, 1e-6);
  for (const double x : {0.0, 0.017, 0.06}) {
    // What is left of the bow falls with 1 / smoothness.
    EXPECT_NEAR(fit.spline.Value(x), line[0] + line[1] * x, 1e-5);
  }
}

TEST(BSplineFit, SmoothingFillsAGap) {
  const Eigen::Vector4d x(0.0, 0.01, 0.02, 0.06), y(0, 1, 2, 6);
  const auto fit = FitBSpline(kBasis, x, y, {.smoothness = 1e-9});
  EXPECT_NEAR(fit.spline.Value(0.04), 4.0, 1e-6);  // a line has no curvature to pay for
}

TEST(BSplineFit, EndPointGaugeIsZeroAtBothEnds) {
  const Points points = Stations();
  const auto free = FitBSpline(kBasis, points.x, points.y);
  const auto fit = FitBSpline(kBasis, points.x, points.y, {.gauge = Gauge::kEndPointLine});
  EXPECT_NEAR(fit.spline.Value(0.0), 0, 16 * kEps);
  EXPECT_NEAR(fit.spline.Value(0.06), 0, 16 * kEps);
  EXPECT_NEAR(fit.StandardUncertainty(0.06), 0, 1e-8);  // sqrt of rounding
  EXPECT_NEAR(fit.spline.Value(0.02) + fit.removed_offset + fit.removed_slope * 0.02,
              free.spline.Value(0.02), 64 * kEps);
}

TEST(BSplineFit, LeastSquaresGaugeIsOrthogonalToLines) {
  const Points points = Stations();
  const auto free = FitBSpline(kBasis, points.x, points.y);
  const auto fit = FitBSpline(kBasis, points.x, points.y, {.gauge = Gauge::kLeastSquaresLine});
  // Simpson's error for a cubic in panels that straddle knots, times length 0.06 and size 1.
  EXPECT_NEAR(Simpson([&](double x) { return fit.spline.Value(x); }), 0, 1e-11);
  EXPECT_NEAR(Simpson([&](double x) { return x * fit.spline.Value(x); }), 0, 1e-12);
  EXPECT_NEAR(fit.spline.Value(0.02) + fit.removed_offset + fit.removed_slope * 0.02,
              free.spline.Value(0.02), 64 * kEps);
}

TEST(BSplineFit, ValueGaugeIsZeroThereAndKeepsTheSlope) {
  const Points points = Stations();
  const auto free = FitBSpline(kBasis, points.x, points.y);
  const auto fit =
      FitBSpline(kBasis, points.x, points.y, {.gauge = Gauge::kValueAt, .gauge_position = 0.025});
  EXPECT_NEAR(fit.spline.Value(0.025), 0, 16 * kEps);
  EXPECT_EQ(fit.removed_slope, 0);
  EXPECT_NEAR(fit.spline.Value(0.05, 1), free.spline.Value(0.05, 1),
              1e-11);  // slopes are about 100
}

// What the gauge takes away and what it leaves add up to the free fit, also where x does not start
// at 0.
TEST(BSplineFit, GaugeTakesALineAndNothingElse) {
  const auto basis = BSplineBasis::Uniform(3, -0.02, 0.04, 10);
  const Points points = Stations();
  const Eigen::VectorXd x = points.x.array() - 0.02;
  const auto free = FitBSpline(basis, x, points.y);
  for (const Gauge gauge : {Gauge::kEndPointLine, Gauge::kLeastSquaresLine, Gauge::kValueAt}) {
    const auto fit = FitBSpline(basis, x, points.y, {.gauge = gauge, .gauge_position = 0.01});
    for (const double at : {-0.02, 0.013, 0.04}) {
      EXPECT_NEAR(fit.spline.Value(at) + fit.removed_offset + fit.removed_slope * at,
                  free.spline.Value(at), 64 * kEps);
    }
    EXPECT_EQ(fit.residual_rms, free.residual_rms);
  }
}

std::string MessageOf(const BSplineBasis& basis, const Points& points) {
  try {
    FitBSpline(basis, points.x, points.y);
  } catch (const NumericalError& error) {
    return error.what();
  }
  return "no NumericalError";
}

TEST(BSplineFit, NamesTheGapThatLeavesACoefficientUndetermined) {
  Points points = Stations();
  for (int k = 0; k < 61; ++k)
    points.x[k] = points.x[k] < 0.03 ? points.x[k] : 0.0001 * k;  // up to 6 mm
  const std::string message = MessageOf(kBasis, points);
  EXPECT_NE(message.find("no point between 0.03"), std::string::npos) << message;
}

TEST(BSplineFit, NamesCrowdedPoints) {
  Points points = Stations();
  for (int k = 0; k < 61; ++k)
    points.x[k] = 0.0599 * (k % 5) / 4;  // five places for ten coefficients
  const std::string message = MessageOf(kBasis, points);
  EXPECT_NE(message.find("too few places and determine only 5 of 10"), std::string::npos)
      << message;
  const Points same{Eigen::VectorXd::Constant(20, 0.03), Eigen::VectorXd::Ones(20)};
  EXPECT_THROW(FitBSpline(kBasis, same.x, same.y, {.smoothness = 1.0}), NumericalError);
}

TEST(BSplineFit, RefusesBadInput) {
  const Points few = Stations(9), points = Stations();
  const auto& [x, y] = points;
  EXPECT_THROW(FitBSpline(kBasis, few.x, few.y), InputError);
  EXPECT_NO_THROW(FitBSpline(kBasis, few.x, few.y, {.smoothness = 1e-9}));
  EXPECT_THROW(FitBSpline(kBasis, x, few.y), InputError);
  EXPECT_THROW(FitBSpline(kBasis, x, y, {.weights = Eigen::VectorXd::Ones(3)}), InputError);
  EXPECT_THROW(FitBSpline(kBasis, x, y, {.weights = Eigen::VectorXd::Zero(61)}), InputError);
  EXPECT_THROW(FitBSpline(kBasis, x, y, {.smoothness = -1.0}), InputError);
  EXPECT_THROW(FitBSpline(kBasis, 2 * x, y), InputError);  // beyond the interval
  EXPECT_THROW(FitBSpline(kBasis, x, y * std::numeric_limits<double>::quiet_NaN()), InputError);
  const auto straight = BSplineBasis::Uniform(1, 0.0, 0.06, 4);
  EXPECT_THROW(FitBSpline(straight, x, y, {.smoothness = 1.0}), InputError);
}

TEST(BSplineFit, InterpolationWithoutWeightsTellsNoUncertainty) {
  const Points points = Stations(10);
  const auto fit = FitBSpline(kBasis, points.x, points.y);
  EXPECT_EQ(fit.covariance.size(), 0);
  EXPECT_THROW(fit.StandardUncertainty(0.01), NumericalError);
  const auto weighted =
      FitBSpline(kBasis, points.x, points.y, {.weights = Eigen::VectorXd::Constant(10, 4.0)});
  EXPECT_NEAR(weighted.StandardUncertainty(points.x[3]), 0.5, 1e-12);  // it goes through the point
}

}  // namespace b_spline_fit_test
}  // namespace abbe::geometry
