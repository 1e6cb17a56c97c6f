#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

#include "failure/failure.h"
#include "standards/cylindricity.h"
#include "standards/diagonals.h"

namespace abbe::standards {
namespace volume_figures_test {

TEST(Diagonals, TheFiguresOfAWorkedExample) {
  const std::vector<DiagonalRuns> runs = {{{0, 2e-6, 5e-6}, {1e-6, 0, 6e-6}},
                                          {{0, -4e-6, 4e-6}, {}}};
  EXPECT_NEAR(EvaluateDiagonal(runs[0]).E, 6e-6, 1e-20);
  EXPECT_NEAR(EvaluateDiagonal(runs[0]).B, 2e-6, 1e-20);
  EXPECT_NEAR(EvaluateDiagonals(runs).E, 8e-6, 1e-20);
  EXPECT_NEAR(EvaluateDiagonals(runs).B, 2e-6, 1e-20);
  EXPECT_THROW(EvaluateDiagonal({{1e-6}, {}}), InputError);
  EXPECT_THROW(EvaluateDiagonal({{1e-6, 2e-6}, {1e-6}}), InputError);
  EXPECT_THROW(EvaluateDiagonal({{1e-6, std::nan("")}, {}}), InputError);
}

// Points of a cylinder that is tilted by (a, b), with lobes in height and angle that a cylinder
// cannot take up: cos 3t and cos 3t at alternating heights.
Eigen::Matrix3Xd Points(double radius, double a, double b, double lobes) {
  constexpr int kAngles = 36, kHeights = 7;
  Eigen::Matrix3Xd points(3, kAngles * kHeights);
  const Eigen::Vector3d axis = Eigen::Vector3d(a, b, 1).normalized();
  const Eigen::Vector3d u = Eigen::Vector3d::UnitY().cross(axis).normalized(), v = axis.cross(u);
  for (int h = 0; h < kHeights; ++h) {
    for (int i = 0; i < kAngles; ++i) {
      const double t = 2 * std::numbers::pi * i / kAngles;
      const double r = radius + lobes * std::cos(3 * t);
      points.col(kAngles * h + i) = Eigen::Vector3d(0.3, -0.2, 0.1) + 0.01 * h * axis +
                                    r * (std::cos(t) * u + std::sin(t) * v);
    }
  }
  return points;
}

TEST(Cylindricity, FindsTheCylinderThatWasMade) {
  const Cylindricity exact = EvaluateCylindricity(Points(0.02, 0.03, -0.02, 0.0));
  EXPECT_NEAR(exact.radius, 0.02, 1e-12);
  EXPECT_NEAR(exact.tilt.x(), 0.03, 1e-10);
  EXPECT_NEAR(exact.tilt.y(), -0.02, 1e-10);
  EXPECT_LT(exact.error, 1e-12);
  const Cylindricity lobed = EvaluateCylindricity(Points(0.02, 1e-4, 0, 3e-6));
  EXPECT_NEAR(lobed.error, 6e-6, 1e-9);
  EXPECT_NEAR(lobed.tilt.x(), 1e-4, 1e-9);
  EXPECT_THROW(EvaluateCylindricity(Points(0.02, 0, 0, 0).leftCols(5)), InputError);
  Eigen::Matrix3Xd flat = Points(0.02, 0, 0, 0).leftCols(36);
  EXPECT_THROW(EvaluateCylindricity(flat), InputError);
}

// How far along one parameter the sum of squares of the distances has its vertex from the fit.
// Distances by a product with the axis, in long double: nothing of the fit's own arithmetic.
double OffTheLeast(const Eigen::Matrix3Xd& points, const Cylindricity& fit, int which) {
  using Real = long double;
  using Vector = Eigen::Matrix<Real, 3, 1>;
  const Real height = points.row(2).cast<Real>().mean();
  const auto squares = [&](Real by) {
    Real p[5] = {fit.centre.x(), fit.centre.y(), fit.tilt.x(), fit.tilt.y(), fit.radius};
    p[which] += by;
    const Vector axis = Vector(p[2], p[3], 1).normalized(), foot(p[0], p[1], height);
    Real sum = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Real off = axis.cross(points.col(i).cast<Real>() - foot).norm() - p[4];
      sum += off * off;
    }
    return sum;
  };
  const Real step = 1e-7L, less = squares(-step), here = squares(0), more = squares(step);
  return static_cast<double>(step / 2 * (less - more) / (less - 2 * here + more));
}

TEST(Cylindricity, IsThatOfTheLeastSquares) {
  for (const auto& [a, b] : {std::pair{0.0, 0.0}, std::pair{0.03, -0.02}, std::pair{-0.2, 0.15}}) {
    for (const double lobes : {3e-6, 200e-6}) {
      Eigen::Matrix3Xd points = Points(0.02, a, b, lobes);
      // And what no lobe does: a cone that is bent, so that no parameter is left at its start.
      for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const double k = static_cast<double>(i);
        points.col(i) += lobes * Eigen::Vector3d(std::sin(0.37 * k * k), std::cos(1.1 * k), 0.3);
      }
      const Cylindricity fit = EvaluateCylindricity(points);
      for (int which = 0; which < 5; ++which) {
        EXPECT_LT(std::abs(OffTheLeast(points, fit, which)), 1e-13) << a << " " << which;
      }
    }
  }
}

}  // namespace volume_figures_test
}  // namespace abbe::standards
