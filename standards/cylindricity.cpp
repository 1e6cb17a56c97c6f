#include "standards/cylindricity.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

using Eigen::Vector3d;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

// Sums of the deviations d and of their derivatives J by centre, tilt and radius.
struct Linearized {
  Matrix5d JtJ = Matrix5d::Zero();
  Vector5d Jtd = Vector5d::Zero();
  double largest = -std::numeric_limits<double>::infinity();
  double smallest = std::numeric_limits<double>::infinity();
};

// The distance of a point is |out|, out = arm - a (a . arm), with the unit vector a of the axis
// through the foot. Along o = out / |out|, which is across a, the axis moves with its tilt t by
// da/dt = e / |(t, 1)| minus its component along a, and the distance by -o_e (a . arm) / |(t, 1)|.
Linearized LinearizedAt(const Cylindricity& fit, double height, const Eigen::Matrix3Xd& points) {
  const Vector3d along(fit.tilt.x(), fit.tilt.y(), 1.0);
  const double length = along.norm();
  const Vector3d axis = along / length, foot(fit.centre.x(), fit.centre.y(), height);
  Linearized sums;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d arm = points.col(i) - foot;
    const double up = axis.dot(arm);
    const Vector3d out = arm - axis * up;
    const double distance = out.norm();
    const double u = out.x() / distance, v = out.y() / distance, h = up / length;
    const Vector5d row(-u, -v, -u * h, -v * h, -1.0);
    const double deviation = distance - fit.radius;
    sums.JtJ += row * row.transpose();
    sums.Jtd += row * deviation;
    sums.largest = std::max(sums.largest, deviation);
    sums.smallest = std::min(sums.smallest, deviation);
  }
  return sums;
}

// The Gauss-Newton step, with parameters scaled to one size. The next step removes its rounding.
Vector5d StepOf(const Linearized& at) {
  constexpr double kIndependent = 1e-12;  // squared sine of a column to the others
  const Vector5d size = at.JtJ.diagonal().cwiseSqrt();
  const Vector5d scale = size.cwiseInverse();
  const Eigen::LDLT<Matrix5d> factors(scale.asDiagonal() * at.JtJ * scale.asDiagonal());
  const bool is_flat = size[2] + size[3] < 1e-9 * (size[0] + size[1]);  // m: heights within 1 nm
  if (is_flat || !scale.allFinite() || !(factors.vectorD().minCoeff() > kIndependent)) {
    throw InputError("the points do not determine a cylinder: spread them in height and angle");
  }
  return -scale.cwiseProduct(factors.solve(scale.cwiseProduct(at.Jtd)));
}

}  // namespace

Cylindricity EvaluateCylindricity(const Eigen::Matrix3Xd& points) {
  if (points.cols() < 6 || !points.allFinite()) {
    throw InputError("a cylinder needs six points or more, all finite");
  }
  const Vector3d mean = points.rowwise().mean();
  Cylindricity fit;
  fit.centre = mean.head<2>();
  fit.radius = (points.colwise() - mean).topRows<2>().colwise().norm().mean();
  constexpr int kMostSteps = 50;
  for (int step = 0; step < kMostSteps; ++step) {
    const Linearized at = LinearizedAt(fit, mean.z(), points);
    const Vector5d change = StepOf(at);
    fit.centre += change.head<2>();
    fit.tilt += change.segment<2>(2);
    fit.radius += change[4];
    if (change.norm() < 1e-13 * (1.0 + fit.radius)) {
      fit.error = at.largest - at.smallest;
      return fit;
    }
  }
  throw NumericalError(
      "the least-squares cylinder did not converge; are the points near a cylinder along z?");
}

}  // namespace abbe::standards
