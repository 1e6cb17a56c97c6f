#include "geometry/b_spline.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "failure/failure.h"

namespace abbe::geometry {
namespace {

void CheckDegree(int degree) {
  if (degree < 0 || degree > BSplineBasis::kMaxDegree) {
    throw InputError(fmt::format("B-spline of degree {}: choose a degree from 0 to {}", degree,
                                 BSplineBasis::kMaxDegree));
  }
}

}  // namespace

BSplineBasis BSplineBasis::Uniform(int degree, double a, double b, int size) {
  CheckDegree(degree);
  if (size <= degree) {
    throw InputError(fmt::format("B-spline of degree {} with {} coefficients: it needs at least {}",
                                 degree, size, degree + 1));
  }
  if (!(std::isfinite(a) && std::isfinite(b) && a < b)) {
    throw InputError(fmt::format("B-spline on [{}, {}]: give an interval with a < b", a, b));
  }
  const int spans = size - degree;
  std::vector<double> knots(degree + 1, a);
  for (int i = 1; i < spans; ++i) knots.push_back(a + (b - a) * i / spans);
  knots.insert(knots.end(), degree + 1, b);
  return BSplineBasis(degree, std::move(knots));
}

BSplineBasis::BSplineBasis(int degree, std::vector<double> knots)
    : degree_(degree), knots_(std::move(knots)) {
  CheckDegree(degree);
  if (size() <= degree) {
    throw InputError(fmt::format("B-spline of degree {} with {} knots: it needs at least {}",
                                 degree, knots_.size(), 2 * degree + 2));
  }
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    if (!std::isfinite(knots_[i]) || (i > 0 && knots_[i] < knots_[i - 1])) {
      throw InputError(fmt::format("B-spline knot {} is {}: give finite knots in ascending order",
                                   i, knots_[i]));
    }
  }
  if (!(a() < b()))
    throw InputError(fmt::format("B-spline on [{}, {}]: the knots leave no interval", a(), b()));
  const int inside = std::max(degree, 1);
  for (int i = 0; i + degree + 1 < static_cast<int>(knots_.size()); ++i) {
    if (knots_[i] == knots_[i + degree + 1] ||
        (knots_[i] == knots_[i + inside] && knots_[i] > a() && knots_[i] < b())) {
      throw InputError(fmt::format(
          "B-spline knot {} repeats too often at {}: at most {} times inside, {} times at an end",
          i, knots_[i], inside, degree + 1));
    }
  }
}

int BSplineBasis::Span(double x) const {
  const auto first = knots_.begin() + degree_;
  const auto last = knots_.begin() + size();
  // At b the span is the last one that is not empty.
  const auto after = x < b() ? std::upper_bound(first, last, x) : std::lower_bound(first, last, x);
  return static_cast<int>(after - knots_.begin()) - 1;
}

BSplineBasis::Local BSplineBasis::At(double x, int derivative) const {
  if (derivative < 0)
    throw InputError(fmt::format("B-spline derivative {}: give 0 or more", derivative));
  const double rounding =
      16 * std::numeric_limits<double>::epsilon() * std::max(std::abs(a()), std::abs(b()));
  if (!(x >= a() - rounding && x <= b() + rounding)) {
    throw InputError(
        fmt::format("B-spline at {:.9g}: outside its interval [{:.9g}, {:.9g}]", x, a(), b()));
  }
  x = std::clamp(x, a(), b());
  const int span = Span(x);
  Local local{span - degree_, {}};
  local.values.setZero(degree_ + 1);
  if (derivative > degree_) return local;

  // values[degree_ - d + r], r = 0..d, holds function span - d + r of degree d, raised in place
  // from d = 0: first by the recurrence for values, then by the one for derivatives.
  auto& values = local.values;
  values[degree_] = 1.0;
  for (int d = 1; d <= degree_; ++d) {
    const bool differentiate = d > degree_ - derivative;
    double carried = 0.0;  // share of function i of degree d - 1 in function i of degree d
    for (int i = span - d; i <= span; ++i) {
      const double next =
          i < span ? values[degree_ - span + i + 1] : 0.0;  // function i + 1, degree d - 1
      const double width = i < span ? knots_[i + d + 1] - knots_[i + 1] : 1.0;
      const double ratio = next / width;
      double& value = values[degree_ - span + i];
      value = carried + (differentiate ? -d * ratio : (knots_[i + d + 1] - x) * ratio);
      carried = differentiate ? d * ratio : (x - knots_[i + 1]) * ratio;
    }
  }
  return local;
}

Eigen::RowVectorXd BSplineBasis::Row(double x, int derivative) const {
  const Local local = At(x, derivative);
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size());
  row.segment(local.first, degree_ + 1) = local.values.transpose();
  return row;
}

Eigen::VectorXd BSplineBasis::LineCoefficients() const {
  if (degree_ == 0)
    throw InputError("B-spline of degree 0 holds no straight line: choose degree 1 or more");
  Eigen::VectorXd line(size());
  for (int i = 0; i < size(); ++i) {
    line[i] = Eigen::Map<const Eigen::VectorXd>(&knots_[i + 1], degree_).mean();
  }
  return line;
}

BSplineBasis::Quadrature BSplineBasis::ProductQuadrature() const {
  // n points are exact to degree 2 n - 1; a product has at most degree 2 kMaxDegree.
  using Gauss = boost::math::quadrature::gauss<double, kMaxDegree + 1>;
  Quadrature quadrature;
  for (int span = degree_; span < size(); ++span) {
    const double half = (knots_[span + 1] - knots_[span]) / 2;
    const double middle = (knots_[span + 1] + knots_[span]) / 2;
    if (half == 0.0) continue;
    for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i) {
      for (const double side : {-1.0, 1.0}) {
        quadrature.points.push_back(middle + side * half * Gauss::abscissa()[i]);
        quadrature.weights.push_back(half * Gauss::weights()[i]);
      }
    }
  }
  return quadrature;
}

BSpline::BSpline(BSplineBasis basis, Eigen::VectorXd coefficients)
    : basis_(std::move(basis)), coefficients_(std::move(coefficients)) {
  if (coefficients_.size() != basis_.size()) {
    throw InputError(fmt::format("B-spline with {} coefficients on a basis of {}: give as many",
                                 coefficients_.size(), basis_.size()));
  }
}

double BSpline::Value(double x, int derivative) const {
  const auto local = basis_.At(x, derivative);
  return local.values.dot(coefficients_.segment(local.first, local.values.size()));
}

}  // namespace abbe::geometry
