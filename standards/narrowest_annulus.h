// The linear programme inside the minimum-zone circle: the narrowest band of circles, to first
// order in the shift of the centre.
//
//   minimise outer - inner   with   inner <= r_i - (x u_i + y v_i) <= outer   for all points i
//
// Units: r, x, y, outer, inner in m; (u, v) is the unit vector from the old centre to the point.
// Method: active set. Solve the programme for a few points (all vertices of its feasible set), add
// the points furthest outside the zone and drop those that do not touch it, until none is outside.
// Each round widens the zone, so the method ends. Failure: NumericalError when it does not end in
// `kMaxRounds` rounds or all points lie in one direction. Validity: exact up to rounding; O(n) per
// round, about ten rounds.
#pragma once

#include <span>

namespace abbe::standards {

struct AnnulusPoint {
  double u, v;  // direction from the centre
  double r;     // distance from the centre
};

struct Annulus {
  double x = 0.0, y = 0.0;  // shift of the centre
  double outer = 0.0, inner = 0.0;

  double Width() const { return outer - inner; }
};

Annulus NarrowestAnnulus(std::span<const AnnulusPoint> points);

}  // namespace abbe::standards
