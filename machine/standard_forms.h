// The linear forms of an error function: B-spline, table, polynomial, Fourier series.
//
// Coefficients have the unit of the function (m or rad).
//   b-spline     c_i B_i(x) on the basis
//   table        c_i is the value at positions[i], straight lines between: the B-spline of degree 1
//   polynomial   c_k T_k(u), Chebyshev, u = -1 ... 1 over [a, b], k = 0 ... degree
//   fourier      [s_1 c_1 s_2 c_2 ...]: s_k sin(2 pi k x / period) + c_k cos(2 pi k x / period)
// Units: x, positions, a, b and period in m. Shapes: coefficients n x 1: as many as the basis or
// the positions have, degree + 1, 2 x harmonics.
// Failure: InputError for fewer than two positions or positions that do not increase, an empty
// interval, a degree outside 0 ... kMaxPolynomialDegree, a period not above 0, fewer than one
// harmonic. The forms are shared: several functions may use one.
// Source: Abramowitz and Stegun, 22.3.15 for T_k(cos t) = cos(k t), evaluated by recurrence.
// Validity: only the B-spline and the table are local: a coefficient of the others moves the error
// of the whole travel.
#pragma once

#include <memory>
#include <vector>

#include "geometry/b_spline.h"
#include "machine/function_form.h"

namespace abbe::machine {

inline constexpr int kMaxPolynomialDegree = 30;

using SharedForm = std::shared_ptr<const FunctionForm>;

// sum of c_i B_i(x).
SharedForm MakeBSplineForm(geometry::BSplineBasis basis);
// Values at `positions`, increasing.
SharedForm MakeTableForm(const std::vector<double>& positions);
// Chebyshev polynomial over [a, b].
SharedForm MakePolynomialForm(int degree, double a, double b);
// Sines and cosines of `harmonics` periods in `period`.
SharedForm MakeFourierForm(int harmonics, double period);

}  // namespace abbe::machine
