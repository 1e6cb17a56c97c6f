#include "geometry/b_spline_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"

namespace abbe::geometry {
namespace {

void CheckPoints(const BSplineBasis& basis, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                 const BSplineFitOptions& options) {
  const auto& weights = options.weights;
  if (x.size() != y.size() || (weights.size() != 0 && weights.size() != x.size())) {
    throw InputError(fmt::format(
        "B-spline fit of {} positions, {} values and {} weights: give one of each per point",
        x.size(), y.size(), weights.size()));
  }
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double weight = weights.size() == 0 ? 1.0 : weights[k];
    if (!std::isfinite(x[k]) || !std::isfinite(y[k]) || !std::isfinite(weight) || weight <= 0) {
      throw InputError(
          fmt::format("B-spline fit, point {}: x = {}, y = {}, weight = {}: give finite numbers "
                      "and a weight above 0",
                      k + 1, x[k], y[k], weight));
    }
  }
  if (!(options.smoothness >= 0) || !std::isfinite(options.smoothness)) {
    throw InputError(
        fmt::format("B-spline fit with smoothness {}: give 0 or more", options.smoothness));
  }
  if (options.smoothness > 0 && basis.degree() < 2) {
    throw InputError(fmt::format(
        "B-spline fit of degree {} with smoothness: it has no curvature, choose degree 2 or more",
        basis.degree()));
  }
  if (options.smoothness == 0 && x.size() < basis.size()) {
    throw InputError(
        fmt::format("B-spline fit of {} coefficients to {} points: give more points, fewer "
                    "coefficients or smoothness",
                    basis.size(), x.size()));
  }
}

// Rows sqrt(weight_k) s''(x_k), so that the sum of their squares is the integral of s''^2.
Eigen::MatrixXd CurvatureRows(const BSplineBasis& basis) {
  const auto quadrature = basis.ProductQuadrature();
  Eigen::MatrixXd rows(quadrature.points.size(), basis.size());
  for (std::size_t k = 0; k < quadrature.points.size(); ++k) {
    rows.row(k) = std::sqrt(quadrature.weights[k]) * basis.Row(quadrature.points[k], 2);
  }
  return rows;
}

[[noreturn]] void ThrowUndetermined(const BSplineBasis& basis, const Eigen::VectorXd& x,
                                    double smoothness, Eigen::Index rank) {
  if (smoothness > 0) {
    throw NumericalError(
        fmt::format("B-spline fit: the points and smoothness {:.3g} determine only {} of {} "
                    "coefficients: give points "
                    "at two places at least, or another smoothness",
                    smoothness, rank, basis.size()));
  }
  for (int i = 0; i < basis.size(); ++i) {
    const double left = basis.knots()[i], right = basis.knots()[i + basis.degree() + 1];
    const auto sees = [&](double at) { return basis.Row(at)[i] != 0; };
    if (std::none_of(x.begin(), x.end(), sees)) {
      throw NumericalError(
          fmt::format("B-spline fit: no point between {:.6g} and {:.6g}, so coefficient {} of {} "
                      "is undetermined: "
                      "measure there, or use fewer coefficients or smoothness",
                      left, right, i + 1, basis.size()));
    }
  }
  throw NumericalError(
      fmt::format("B-spline fit: the points lie at too few places and determine only {} of {} "
                  "coefficients: spread "
                  "them, or use fewer coefficients or smoothness",
                  rank, basis.size()));
}

// The line of a spline that the gauge removes: (offset, slope) = functional * coefficients, where
// the line is offset + slope (x - a).
Eigen::MatrixXd LineFunctional(const BSplineBasis& basis, const BSplineFitOptions& options) {
  const double a = basis.a(), length = basis.b() - basis.a();
  Eigen::MatrixXd line = Eigen::MatrixXd::Zero(2, basis.size());
  switch (options.gauge) {
    case Gauge::kNone:
      break;
    case Gauge::kValueAt:
      line.row(0) = basis.Row(options.gauge_position);
      break;
    case Gauge::kEndPointLine:
      line.row(0) = basis.Row(a);
      line.row(1) = (basis.Row(basis.b()) - basis.Row(a)) / length;
      break;
    case Gauge::kLeastSquaresLine: {
      // With u = (x - middle) / (length / 2), 1 and u are orthogonal: integrals length, length / 3.
      const auto quadrature = basis.ProductQuadrature();
      Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(basis.size()), tilt = mean;
      for (std::size_t k = 0; k < quadrature.points.size(); ++k) {
        const double u = 2 * (quadrature.points[k] - a) / length - 1;
        const Eigen::RowVectorXd row =
            quadrature.weights[k] / length * basis.Row(quadrature.points[k]);
        mean += row;
        tilt += 3 * u * row;
      }
      line.row(0) = mean - tilt;
      line.row(1) = 2 / length * tilt;
      break;
    }
  }
  return line;
}

// Projection that removes that line from the coefficients.
Eigen::MatrixXd GaugeProjection(const BSplineBasis& basis, const BSplineFitOptions& options,
                                const Eigen::MatrixXd& line) {
  Eigen::MatrixXd line_coefficients = Eigen::MatrixXd::Zero(basis.size(), 2);
  line_coefficients.col(0).setOnes();
  if (options.gauge == Gauge::kEndPointLine || options.gauge == Gauge::kLeastSquaresLine) {
    line_coefficients.col(1) = basis.LineCoefficients().array() - basis.a();
  }
  return Eigen::MatrixXd::Identity(basis.size(), basis.size()) - line_coefficients * line;
}

struct Solution {
  Eigen::VectorXd coefficients;
  // U U' = (rows' rows)^-1, and seen = (the weighted rows of the points alone) * U. The covariance
  // of the coefficients is U seen' seen U' times the variance of unit weight.
  Eigen::MatrixXd U, seen;
};

Solution Solve(const BSplineBasis& basis, const Eigen::MatrixXd& B, const Eigen::VectorXd& x,
               const Eigen::VectorXd& y, const BSplineFitOptions& options) {
  const Eigen::Index n = B.rows(), m = B.cols();
  const Eigen::VectorXd root_weights = options.weights.size() == 0
                                           ? Eigen::VectorXd::Ones(n).eval()
                                           : options.weights.cwiseSqrt().eval();
  Eigen::MatrixXd rows = root_weights.asDiagonal() * B;
  Eigen::VectorXd values = root_weights.cwiseProduct(y);
  if (options.smoothness > 0) {
    const Eigen::MatrixXd curvature = std::sqrt(options.smoothness) * CurvatureRows(basis);
    rows.conservativeResize(n + curvature.rows(), m);
    rows.bottomRows(curvature.rows()) = curvature;
    values.conservativeResize(rows.rows());
    values.tail(curvature.rows()).setZero();
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rows);
  if (qr.rank() < m) ThrowUndetermined(basis, x, options.smoothness, qr.rank());
  const auto R = qr.matrixR().topLeftCorner(m, m).triangularView<Eigen::Upper>();
  const Eigen::MatrixXd U = qr.colsPermutation() * R.solve(Eigen::MatrixXd::Identity(m, m));
  return {qr.solve(values), U, rows.topRows(n) * U};
}

}  // namespace

Eigen::MatrixXd SmoothnessMatrix(const BSplineBasis& basis) {
  const Eigen::MatrixXd rows = CurvatureRows(basis);
  return rows.transpose() * rows;
}

BSplineFit FitBSpline(const BSplineBasis& basis, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                      const BSplineFitOptions& options) {
  CheckPoints(basis, x, y, options);
  Eigen::MatrixXd B(x.size(), basis.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) B.row(k) = basis.Row(x[k]);
  const Solution solution = Solve(basis, B, x, y, options);
  const Eigen::MatrixXd line = LineFunctional(basis, options);
  const Eigen::MatrixXd projection = GaugeProjection(basis, options, line);
  const Eigen::Vector2d removed = line * solution.coefficients;

  const Eigen::VectorXd residuals = y - B * solution.coefficients;
  const double points = x.size();
  const double effective_parameters = solution.seen.squaredNorm();
  const double redundancy = points - effective_parameters;
  const bool weighted = options.weights.size() != 0;
  Eigen::MatrixXd covariance(0, 0);
  if (weighted || redundancy > 1e-9 * points) {  // below that it is rounding of the trace
    const Eigen::MatrixXd spread = projection * solution.U * solution.seen.transpose();
    covariance =
        (weighted ? 1.0 : residuals.squaredNorm() / redundancy) * spread * spread.transpose();
  }
  return {BSpline(basis, projection * solution.coefficients),
          std::move(covariance),
          std::sqrt(residuals.squaredNorm() / points),
          effective_parameters,
          removed[0] - removed[1] * basis.a(),
          removed[1]};
}

double BSplineFit::StandardUncertainty(double x, int derivative) const {
  if (covariance.size() == 0) {
    throw NumericalError(
        "B-spline fit: as many coefficients as points leave no redundancy, so the uncertainty is "
        "unknown: give weights");
  }
  const Eigen::RowVectorXd row = spline.basis().Row(x, derivative);
  return std::sqrt(row * covariance * row.transpose());
}

}  // namespace abbe::geometry
