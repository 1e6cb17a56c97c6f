#include "machine/error_function.h"

#include <fmt/format.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "failure/failure.h"

namespace abbe::machine {
namespace {

// The slope of the least-squares line of f over the travel,
//
//   12 / length^3 * integral of (x - middle) f(x) dx = sum of weights * f(points)
struct LineRule {
  std::vector<double> points, weights;
};

LineRule RuleFor(const FunctionForm& form, const Travel& travel) {
  using Gauss = boost::math::quadrature::gauss<double, 16>;
  const double middle = (travel.last + travel.first) / 2;
  const double factor = 12 / std::pow(travel.last - travel.first, 3);
  const std::vector<double> pieces = form.Pieces(travel.first, travel.last);
  LineRule rule;
  for (std::size_t piece = 1; piece < pieces.size(); ++piece) {
    const double half = (pieces[piece] - pieces[piece - 1]) / 2;
    const double center = (pieces[piece] + pieces[piece - 1]) / 2;
    for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i) {
      for (const double side : {-1.0, 1.0}) {
        const double x = center + side * half * Gauss::abscissa()[i];
        rule.points.push_back(x);
        rule.weights.push_back(factor * half * Gauss::weights()[i] * (x - middle));
      }
    }
  }
  return rule;
}

}  // namespace

ErrorFunction::ErrorFunction(int axis, int motion, SharedForm form, const Travel& travel,
                             Gauge gauge)
    : axis_(axis),
      motion_(motion),
      form_(std::move(form)),
      gauge_(gauge),
      travel_(travel),
      coefficients_(Eigen::VectorXd::Zero(form_->size())) {
  if (!(travel.first < travel.last)) {
    throw InputError(
        fmt::format("the travel of {}, {} to {} mm, is empty: its first end must be below the last",
                    "XYZ"[axis], 1e3 * travel.first, 1e3 * travel.last));
  }
  UpdateGauge();
}

void ErrorFunction::SetCoefficients(const Eigen::Ref<const Eigen::VectorXd>& coefficients) {
  if (coefficients.size() != coefficients_.size()) {
    throw InputError(fmt::format("{} coefficients for {}, which has {}", coefficients.size(),
                                 MotionName(axis_, motion_), coefficients_.size()));
  }
  if (!coefficients.allFinite()) {
    throw InputError(
        fmt::format("a coefficient of {} is not a finite number", MotionName(axis_, motion_)));
  }
  coefficients_ = coefficients;
  if (form_ == nullptr || gauge_ == Gauge::kNone) return;
  if (!form_->IsLinear()) return UpdateGauge();
  offset_ = offset_gradient_.dot(coefficients_);
  slope_ = slope_gradient_.dot(coefficients_);
}

void ErrorFunction::UpdateGauge() {
  if (gauge_ == Gauge::kNone) {
    offset_gradient_ = slope_gradient_ = Eigen::VectorXd::Zero(size());
    return;
  }
  const double* const c = coefficients_.data();
  Eigen::VectorXd row(size());
  offset_ = form_->Evaluate(travel_.first, c, nullptr, row.data());
  offset_gradient_ = row;
  slope_ = 0.0;
  slope_gradient_ = Eigen::VectorXd::Zero(size());
  if (!IsStraightness(axis_, motion_)) return;
  const LineRule rule = RuleFor(*form_, travel_);
  for (std::size_t i = 0; i < rule.points.size(); ++i) {
    slope_ += rule.weights[i] * form_->Evaluate(rule.points[i], c, nullptr, row.data());
    slope_gradient_ += rule.weights[i] * row;
  }
}

double ErrorFunction::Evaluate(double x, double* slope, double* gradient) const {
  if (form_ == nullptr) {
    if (slope != nullptr) *slope = 0.0;
    return 0.0;
  }
  x = InTravel(travel_, axis_, x);
  const double along = x - travel_.first;
  const double value = form_->Evaluate(x, coefficients_.data(), slope, gradient);
  if (slope != nullptr) *slope -= slope_;
  if (gradient != nullptr) {
    Eigen::Map<Eigen::VectorXd>(gradient, size()) -= offset_gradient_ + along * slope_gradient_;
  }
  return value - offset_ - along * slope_;
}

}  // namespace abbe::machine
