// B-splines of any degree on an interval [a, b]: the basis, and functions made of it.
//
// A basis has `size` functions on the knots t_0 <= ... <= t_(size+degree); every function is a
// polynomial of that degree between knots and is zero outside its degree + 1 spans. They add up to
// 1 everywhere.
//
//   const auto basis = BSplineBasis::Uniform(3, 0.0, 0.06, 12);  // cubic, 12 coefficients
//   const BSpline straightness(basis, coefficients);
//   const double slope = straightness.Value(0.031, 1);           // first derivative
//
// Units: whatever the caller uses; derivatives divide by the unit of x. Shapes: rows are 1 x size.
// Failure: InputError for a degree outside 0 ... kMaxDegree, knots that decrease, an inner knot of
// multiplicity above `degree`, an empty interval, and for x outside [a, b]: there is no
// extrapolation. An x beyond an end by rounding only (16 eps of the ends) counts as the end.
// Source: de Boor, "A Practical Guide to Splines" (2001), chapters IX (14) and X (12).
// Validity: at a knot where a derivative jumps, its value is that of the span to the right; at b
// that of the span to the left. Degrees above about 10 lose digits.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::geometry {

class BSplineBasis {
 public:
  static constexpr int kMaxDegree = 15;  // a fixed size: At() needs no heap

  // `size` functions with equally spaced knots on [a, b]; the end knots have multiplicity degree +
  // 1, so the first and last coefficient are the end values of a spline. size > degree.
  static BSplineBasis Uniform(int degree, double a, double b, int size);

  // Given knots, size + degree + 1 of them. The interval is [t_degree, t_size].
  BSplineBasis(int degree, std::vector<double> knots);

  int degree() const { return degree_; }
  int size() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  double a() const { return knots_[degree_]; }
  double b() const { return knots_[size()]; }
  const std::vector<double>& knots() const { return knots_; }

  // Values at x of the functions that are not zero there: number `first` and the `degree` after it.
  struct Local {
    int first;
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDegree + 1, 1> values;
  };
  Local At(double x, int derivative = 0) const;

  // All functions at x, so that Row(x, k) * coefficients is the k-th derivative of the spline.
  Eigen::RowVectorXd Row(double x, int derivative = 0) const;

  // The coefficients of the straight line x (Greville's points): the averages of `degree` knots.
  // InputError for degree 0, which contains no line.
  Eigen::VectorXd LineCoefficients() const;

  // Points and weights that integrate products of two splines of this basis, or of their
  // derivatives, exactly over [a, b] (Gauss-Legendre on each span).
  struct Quadrature {
    std::vector<double> points, weights;
  };
  Quadrature ProductQuadrature() const;

 private:
  int Span(double x) const;  // t_span <= x < t_(span+1), or the last span that is not empty at b

  int degree_;
  std::vector<double> knots_;
};

// One function of a basis. Coefficients: size x 1, in the unit of the value.
class BSpline {
 public:
  // InputError when the number of coefficients is not the size of the basis.
  BSpline(BSplineBasis basis, Eigen::VectorXd coefficients);

  double Value(double x, int derivative = 0) const;

  const BSplineBasis& basis() const { return basis_; }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }

 private:
  BSplineBasis basis_;
  Eigen::VectorXd coefficients_;
};

}  // namespace abbe::geometry
