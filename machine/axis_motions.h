// Fast evaluation of the six error motions of one axis: piecewise polynomials on common pieces of
// the travel.
//
//   const AxisMotions motions(0, functions, travel);
//   const geometry::ErrorVector<double> errors = motions.At(0.03);    // [EXX EYX EZX EAX EBX ECX]
//
// On each piece all six are one polynomial with six values,
//
//   f(x) = c0 + t (c1 + t (c2 + ...)),   t = (x - left) / width,
//
// that interpolates the functions, gauge included, at Chebyshev points of the piece. A form that is
// not piecewise polynomial (Fourier, a network) is evaluated directly.
// Frames: the motions are those of the carriage in M (error_motion.h).
// Units: m, rad. Shapes: [EXX EYX EZX EAX EBX ECX] of the axis, 6 x 1.
// Failure: InputError for a position outside the travel.
// Source: own.
// Validity: a copy of the functions at construction; equal to them to 1e-12 of their size, cubic
// ones to 1e-14.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "geometry/transform.h"
#include "machine/error_function.h"

namespace abbe::machine {

class AxisMotions {
 public:
  AxisMotions(int axis, const std::array<ErrorFunction, kMotions>& functions, const Travel& travel);

  // The six motions at x, where the control shows x.
  geometry::ErrorVector<double> At(double x) const;

 private:
  std::size_t PieceOf(double x) const;

  int axis_;
  Travel travel_;
  int degree_ = 0;
  std::vector<double> ends_;  // of the pieces: their number + 1
  std::vector<double> per_width_;
  std::vector<geometry::ErrorVector<double>> coefficients_;  // degree + 1 per piece
  // Lookup table: cells of equal width and the piece at the beginning of each.
  std::vector<std::size_t> first_piece_;
  double cells_per_m_;
  std::vector<std::pair<int, ErrorFunction>> others_;
};

}  // namespace abbe::machine
