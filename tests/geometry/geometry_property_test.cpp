#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/b_spline.h"
#include "geometry/transform.h"

namespace abbe::geometry {
namespace geometry_property_test {

using Eigen::Vector3d;
constexpr double kEps = std::numeric_limits<double>::epsilon();

double In(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1'000'001) / 1e6;
}

Vector3d VectorIn(double size) { return {In(-size, size), In(-size, size), In(-size, size)}; }

Transform<double> AnyPose() { return {ExpRotation<double>(VectorIn(3)), VectorIn(1)}; }

RC_GTEST_PROP(GeometryProperty, ARotationIsOrthogonalAndRightHanded, ()) {
  const Eigen::Matrix3d R = ExpRotation<double>(VectorIn(10));
  RC_ASSERT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 16 * kEps);
  RC_ASSERT(std::abs(R.determinant() - 1) < 16 * kEps);
}

// A change of frame commutes with exp: R exp(v) R' = exp(R v).
RC_GTEST_PROP(GeometryProperty, ExpFollowsAChangeOfFrame, ()) {
  const Vector3d v = VectorIn(2);
  const Eigen::Matrix3d R = ExpRotation<double>(VectorIn(3));
  RC_ASSERT((R * ExpRotation<double>(v) * R.transpose() - ExpRotation<double>(R * v)).norm() <
            64 * kEps);
}

RC_GTEST_PROP(GeometryProperty, PosesFormAGroup, ()) {
  const auto X_AB = AnyPose(), X_BC = AnyPose(), X_CD = AnyPose();
  const auto near = [](const Transform<double>& a, const Transform<double>& b) {
    return (a.Matrix() - b.Matrix()).norm() < 64 * kEps;
  };
  RC_ASSERT(near((X_AB * X_BC) * X_CD, X_AB * (X_BC * X_CD)));
  RC_ASSERT(near((X_AB * X_BC).Inverse(), X_BC.Inverse() * X_AB.Inverse()));
  RC_ASSERT(near(X_AB * X_AB.Inverse(), Transform<double>{}));
}

// A basis of any degree up to 7 with unequal knots, some double, clamped at both ends.
BSplineBasis AnyBasis() {
  const int degree = *rc::gen::inRange(2, 8);
  std::vector<double> inner;
  for (int i = *rc::gen::inRange(0, 8); i > 0; --i) inner.push_back(*rc::gen::inRange(1, 20));
  std::sort(inner.begin(), inner.end());
  std::vector<double> knots(degree + 1, 0.0);
  for (const double knot : inner) {
    if (std::count(knots.begin(), knots.end(), knot) < 2) knots.push_back(knot);
  }
  knots.insert(knots.end(), degree + 1, 20.0);
  return BSplineBasis(degree, knots);
}

RC_GTEST_PROP(GeometryProperty, BasisFunctionsArePositiveAndAddUpToOne, ()) {
  const BSplineBasis basis = AnyBasis();
  const Eigen::RowVectorXd row = basis.Row(In(0, 20));
  RC_ASSERT(row.minCoeff() >= 0.0);
  RC_ASSERT(std::abs(row.sum() - 1) < 32 * kEps);
}

RC_GTEST_PROP(GeometryProperty, DerivativesAgreeWithFiniteDifferences, ()) {
  const BSplineBasis basis = AnyBasis();
  Eigen::VectorXd c(basis.size());
  for (double& value : c) value = In(-1, 1);
  const BSpline spline(basis, c);
  // Off the knots, which are whole numbers; central differences: h^2/6 s''' and eps/h.
  const double x = *rc::gen::inRange(0, 20) + In(0.1, 0.9), h = 1e-5;
  for (int k = 0; k < basis.degree(); ++k) {
    const double difference = (spline.Value(x + h, k) - spline.Value(x - h, k)) / (2 * h);
    // Each derivative grows at most by 2 degree / smallest span, which is 1.
    const double size = std::pow(2.0 * basis.degree(), k);
    const double third = size * std::pow(2.0 * basis.degree(), 3);
    RC_ASSERT(std::abs(spline.Value(x, k + 1) - difference) <
              h * h / 6 * third + 64 * kEps / h * size);
  }
}

}  // namespace geometry_property_test
}  // namespace abbe::geometry
