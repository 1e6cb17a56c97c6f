// An error function: one error motion over the travel of its axis, as a form, its coefficients and
// the gauge. Positions are those that the control shows (chain.h).
//
//   f(x) = form(x; c) - form(x0; c) - s (x - x0)         x0 the first end of the travel [x0, x1]
//
// Gauge: every error function is zero at x0. A straightness also has no linear part, because the
// slope of an axis is its squareness: s is then the slope of the least-squares line of the form
// over the full travel with uniform weight, else 0. The integral in s is exact to rounding for
// every form, so the gauge holds for any coefficients and needs no constraint. With Gauge::kNone f
// is the form itself: for imported tables, whose constants and slopes are part of the error.
//
//   ErrorFunction eyx(0, 1, MakePolynomialForm(4, 0.0, 0.06), {0.0, 0.06});
//   eyx.SetCoefficients(c);
//   double slope; const double value = eyx.Evaluate(0.03, &slope);
//
// Frames: values are motions of the carriage in M (error_motion.h).
// Units: x in m, values in m or rad. Shapes: coefficients and gradient n x 1.
// Failure: InputError for coefficients of another number than the form's or not finite, for an
// empty travel and for x outside the travel (there is no extrapolation; 16 eps of the ends count as
// the end).
// Source: own; the slope is that of the least-squares line with uniform weight, s = 12 / L^3 times
// the integral of (x - middle) form(x), L the travel.
// Validity: inside the travel; a slope is that of the whole travel, so the line of a part of it may
// be inclined.
#pragma once

#include <Eigen/Core>

#include "machine/error_motion.h"
#include "machine/machine.h"
#include "machine/standard_forms.h"

namespace abbe::machine {

enum class Gauge { kZeroAtStart, kNone };

class ErrorFunction {
 public:
  ErrorFunction() = default;  // zero at every x, no coefficients
  // Motion `motion` of axis `axis`, error_motion.h; c = 0.
  ErrorFunction(int axis, int motion, SharedForm form, const Travel& travel,
                Gauge gauge = Gauge::kZeroAtStart);

  int size() const { return static_cast<int>(coefficients_.size()); }
  const SharedForm& form() const { return form_; }  // null: zero at every x
  Gauge gauge() const { return gauge_; }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }
  // n numbers, as the form counts them.
  void SetCoefficients(const Eigen::Ref<const Eigen::VectorXd>& coefficients);

  // f(x). Unless null, *slope becomes df/dx and gradient[0 ... n-1] df/dc.
  double Evaluate(double x, double* slope = nullptr, double* gradient = nullptr) const;

 private:
  void UpdateGauge();

  int axis_ = 0, motion_ = 0;
  SharedForm form_;
  Gauge gauge_ = Gauge::kZeroAtStart;
  Travel travel_{0.0, 0.0};
  Eigen::VectorXd coefficients_;
  double offset_ = 0.0, slope_ = 0.0;
  Eigen::VectorXd offset_gradient_, slope_gradient_;
};

}  // namespace abbe::machine
