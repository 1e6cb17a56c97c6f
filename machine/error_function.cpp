#include "machine/error_function.h"

#include <fmt/format.h>

#include <boost/math/quadrature/gauss.hpp>
#include <utility>

#include "failure/failure.h"

namespace abbe::machine {
ErrorFunction::ErrorFunction(int axis, int motion, SharedForm form, const Travel& travel)
    : axis_(axis), motion_(motion), form_(std::move(form)), travel_(travel) {
  if (!(travel.first < travel.last)) {
    throw InputError(
        fmt::format("the travel {} ... {} m is empty: the first end stands below the "
                    "last",
                    travel.first, travel.last));
  }
  coefficients_ = Eigen::VectorXd::Zero(form_->size());
  if (IsStraightness(axis, motion)) {
    // slope = 12 / length^3 * integral of (x - middle) f(x)
    using Gauss = boost::math::quadrature::gauss<double, 16>;
    const auto& abscissa = Gauss::abscissa();
    const auto& weight = Gauss::weights();
    const std::vector<double> pieces = form_->Pieces(travel.first, travel.last);
    const double length = travel.last - travel.first, middle = (travel.last + travel.first) / 2;
    const auto count = static_cast<Eigen::Index>(2 * abscissa.size() * (pieces.size() - 1));
    points_.resize(count);
    weights_.resize(count);
    Eigen::Index point = 0;
    for (std::size_t piece = 1; piece < pieces.size(); ++piece) {
      const double half = (pieces[piece] - pieces[piece - 1]) / 2;
      const double center = (pieces[piece] + pieces[piece - 1]) / 2;
      for (std::size_t i = 0; i < abscissa.size(); ++i) {
        for (const double side : {-1.0, 1.0}) {
          const double x = center + side * half * abscissa[i];
          points_[point] = x;
          weights_[point++] = half * weight[i] * (x - middle) * 12 / (length * length * length);
        }
      }
    }
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
  if (form_ == nullptr) return;
  if (!form_->IsLinear()) return UpdateGauge();
  offset_ = offset_gradient_.dot(coefficients_);
  slope_ = slope_gradient_.dot(coefficients_);
}

void ErrorFunction::UpdateGauge() {
  const double* const c = coefficients_.data();
  Eigen::VectorXd row(size());
  offset_ = form_->Evaluate(travel_.first, c, nullptr, row.data());
  offset_gradient_ = row;
  slope_ = 0.0;
  slope_gradient_ = Eigen::VectorXd::Zero(size());
  for (Eigen::Index i = 0; i < points_.size(); ++i) {
    slope_ += weights_[i] * form_->Evaluate(points_[i], c, nullptr, row.data());
    slope_gradient_ += weights_[i] * row;
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
