// Least-squares B-spline through measured points, with its covariance.
//
//   minimise  sum_k w_k (y_k - s(x_k))^2 + smoothness * integral over [a, b] of s''(x)^2 dx
//
// The gauge, if one is chosen, is removed afterwards: the line through the end values, the
// least-squares line, or the value at one place, which the points do not determine or which belongs
// to another error. The removal is an exact projection of the coefficients, for a straight line is
// itself a spline.
//
//   const auto fit = FitBSpline(BSplineBasis::Uniform(3, 0.0, 0.06, 12), x, y,
//                               {.gauge = Gauge::kEndPointLine});
//   fit.spline.Value(0.03);  fit.StandardUncertainty(0.03);
//
// Units: x and y as the caller's, weights 1/unit(y)^2, smoothness unit(x)^3/unit(y)^2 with weights
// and unit(x)^3 without. Shapes: x, y, weights n x 1; coefficients m x 1, covariance m x m.
// Failure: InputError for lists of different length, values that are not finite, weights not above
// 0, a negative smoothness, smoothness with degree below 2, a line gauge with degree 0, x outside
// the interval, fewer points than coefficients without smoothness. NumericalError when the points
// leave coefficients undetermined; it names where points are missing. Nothing is returned then.
// Source: penalised least squares, Eilers and Marx, Statistical Science 11 (1996), with the exact
// integral of s''^2 in place of their differences; solved by QR, never by normal equations.
// Validity: the covariance is the propagated noise of the points. It holds no bias: with smoothness
// the fit is flatter than the truth. Up to some 10^4 points (a dense n x m matrix).
#pragma once

#include <Eigen/Core>

#include "geometry/b_spline.h"

namespace abbe::geometry {

enum class Gauge {
  kNone,
  kEndPointLine,      // s(a) = s(b) = 0
  kLeastSquaresLine,  // integral of s and of x s over [a, b] are 0 (uniform weight)
  kValueAt,           // s(gauge_position) = 0
};

struct BSplineFitOptions {
  Eigen::VectorXd weights = {};  // 1/u^2 of each point; empty: equal and unknown
  double smoothness = 0.0;
  Gauge gauge = Gauge::kNone;
  double gauge_position = 0.0;
};

struct BSplineFit {
  BSpline spline;
  // m x m, of the coefficients. Without weights the variance of a point is estimated from the
  // residuals; 0 x 0 when there is no redundancy.
  Eigen::MatrixXd covariance;
  double residual_rms;          // of y_k - fit, not weighted
  double effective_parameters;  // trace of the hat matrix: m without smoothness, fewer with it
  // The removed gauge: the points are near spline + removed_offset + removed_slope * x.
  double removed_offset;
  double removed_slope;

  // Standard uncertainty of spline.Value(x, derivative). NumericalError without a covariance.
  double StandardUncertainty(double x, int derivative = 0) const;
};

BSplineFit FitBSpline(const BSplineBasis& basis, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                      const BSplineFitOptions& options = {});

// The m x m matrix K of the smoothness: c' K c = integral of s''^2 over [a, b], c the coefficients.
Eigen::MatrixXd SmoothnessMatrix(const BSplineBasis& basis);

}  // namespace abbe::geometry
