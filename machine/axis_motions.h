// Fast evaluation of the six error motions of one axis: piecewise polynomials on common pieces of
// the travel.
//
//   const AxisMotions motions(0, functions, travel);
//   const geometry::ErrorVector<double> errors = motions.At(0.03);    // [EXX EYX EZX EAX EBX ECX]
//   motions.At(places, values, &slopes);                              // of many positions
//
// On each piece all six are one polynomial with six values,
//
//   f(x) = c0 + t (c1 + t (c2 + ...)),   t = (x - left) / width,
//
// that interpolates the functions, gauge included, at Chebyshev points of the piece. A form that is
// not piecewise polynomial (Fourier, a network) is evaluated directly.
// Frames: the motions are those of the carriage in M (error_motion.h).
// Units: m, rad. Shapes: [EXX EYX EZX EAX EBX ECX] of the axis, 6 x 1; in a block of many positions
// each in a row of its own, three shifts and three turns apart.
// Failure: InputError for a position outside the travel.
// Source: own.
// Validity: a copy of the functions at construction; equal to them to 1e-12 of their size, cubic
// ones to 1e-14.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "geometry/transform.h"
#include "machine/error_function.h"

namespace abbe::machine {

// The motions of one axis at up to kBlock positions; the fourth numbers mean nothing.
struct MotionBlock {
  static constexpr int kBlock = 32;
  alignas(64) double shifts[kBlock][4] = {};  // [EX EY EZ], m
  alignas(64) double turns[kBlock][4] = {};   // [EA EB EC], rad

  // One motion, 0 to 5, at one of the positions.
  double& At(std::size_t i, int motion) {
    return motion < kAxes ? shifts[i][motion] : turns[i][motion - kAxes];
  }
  double At(std::size_t i, int motion) const {
    return motion < kAxes ? shifts[i][motion] : turns[i][motion - kAxes];
  }
};

// Those of one power of t, in the same order.
struct alignas(64) MotionCoefficients {
  double shift[4] = {}, turn[4] = {};
};

// Where a position lies: the coefficients of its piece, t and dt / dx, 1/m.
struct PlaceInPiece {
  const MotionCoefficients* coefficients;
  double t, per_width;
};

class AxisMotions {
 public:
  AxisMotions(int axis, const std::array<ErrorFunction, kMotions>& functions, const Travel& travel);

  // The six motions at x, where the control shows x.
  geometry::ErrorVector<double> At(double x) const;
  // At up to kBlock positions, with the derivatives by the position unless `slopes` is null; fast
  // where the axis does not move from one to the next.
  void At(std::span<const double> places, MotionBlock& values, MotionBlock* slopes = nullptr) const;

 private:
  PlaceInPiece PlaceOf(double x) const;
  std::size_t PieceOf(double x) const;

  int axis_;
  Travel travel_;
  int degree_ = 0;
  std::vector<double> ends_;  // of the pieces: their number + 1
  std::vector<double> per_width_;
  std::vector<MotionCoefficients> coefficients_;  // degree + 1 per piece
  // Lookup table: cells of equal width and the piece at the beginning of each.
  std::vector<std::size_t> first_piece_;
  double cells_per_m_;
  std::vector<std::pair<int, ErrorFunction>> others_;
};

}  // namespace abbe::machine
