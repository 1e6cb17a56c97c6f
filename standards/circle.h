// Reference circles of a measured path: least squares and minimum zone.
//
//   const Roundness zone = EvaluateRoundness(CircleKind::kMinimumZone, x, y);
//   zone.circle.x, zone.circle.y, zone.Error();
//
// Frames: x and y are the two coordinates of the plane, in any origin. A deviation is the distance
// to the centre minus the radius: positive outside. Units: m. Shapes: n points, in any order, of a
// whole circle or an arc; points of both senses may be evaluated together. `weights`: the arc that
// each point stands for (ArcsOf, any common unit); none: equal arcs. The minimum zone has no use
// for them.
// Failure: InputError for fewer than three points, lists of different length, numbers that are not
// finite, or points on a line. NumericalError when the iteration does not converge (deviations that
// are not small compared with the radius). Source: ISO 12181-1:2011, clause 3 (reference circles),
// and ISO 230-4:2022, clause 3; not checked against their texts. Least squares: the weighted
// squares of the radial deviations, by Gauss-Newton from the algebraic circle of Kasa (1976). Minimum zone: two
// concentric circles of smallest separation. About a centre c near the solution the distance of
// point i is r_i - c u_i + O(|c|^2 / r), so each step is a linear programme in (c, outer, inner);
// it is solved exactly by adding the points outside its zone, and repeated about the new centre
// until the centre converges. Validity: deviations below a few percent of the radius; the zone is
// then the global minimum. Law: minimum zone <= least squares.
#pragma once

#include <span>
#include <vector>

namespace abbe::standards {

enum class CircleKind { kLeastSquares, kMinimumZone };

struct Circle {
  double x = 0.0;
  double y = 0.0;
  double radius = 0.0;  // minimum zone: mean of the two circles
};

// The reference circle of this kind.
Circle ReferenceCircle(CircleKind kind, std::span<const double> x, std::span<const double> y,
                       std::span<const double> weights = {});

// The arc about (0, 0) for which each point stands, rad: half the way to each of its two neighbours
// by angle, the last and the first being neighbours; all turns together, so what one turn lacks
// another gives. A gap above a twentieth of a turn was not measured and counts as a usual step (the
// median). With it a least-squares circle does not depend on how densely parts of the path were
// sampled.
std::vector<double> ArcsOf(std::span<const double> x, std::span<const double> y);

// The figures of ISO 12181-1:2011 about a reference circle; for the minimum zone Error() is RONt.
struct Roundness {
  Circle circle;
  double peak = 0.0;    // largest deviation outwards
  double valley = 0.0;  // largest deviation inwards, not negative
  double rms = 0.0;

  double Error() const { return peak + valley; }
};

Roundness EvaluateRoundness(CircleKind kind, std::span<const double> x, std::span<const double> y,
                            std::span<const double> weights = {});

// The distance of each point to (circle.x, circle.y), minus circle.radius.
std::vector<double> RadialDeviations(const Circle& circle, std::span<const double> x,
                                     std::span<const double> y);

}  // namespace abbe::standards
