// The three reference lines of ISO 230-1, from which straightness and squareness are judged.
//
// Frames: x runs along the axis, y is the deviation across it; a line is y = offset + slope x.
// Units: x and y in m, slope in rad (its tangent, at machine-tool slopes the same). Shapes: n
// values each. Failure: InputError for fewer than two points, lists of different length, values
// that are not finite, or two points at the same x (average the passes of a station first). The
// order of points is free. Source: ISO 230-1:2012, clause 3 (end-point, least-squares and
// minimum-zone reference line); not checked against its text. Minimum zone: the zone's width is a
// convex function of the slope and smallest where one of its borders lies on an edge of the convex
// hull; the hull by Andrew's monotone chain, the edges visited in order of slope (rotating
// calipers). Exact, O(n log n). Validity: widths are measured along y, not across the line; at a
// slope of 1 mrad the two differ by 0.5e-6 of the width.
#pragma once

#include <span>

namespace abbe::standards {

enum class LineKind { kEndPoints, kLeastSquares, kMinimumZone };

struct Line {
  double slope = 0.0;
  double offset = 0.0;

  double At(double x) const { return offset + slope * x; }
};

// End points: through the points of smallest and largest x. Least squares: equal weights. Minimum
// zone: the middle of the narrowest band that holds all points.
Line ReferenceLine(LineKind kind, std::span<const double> x, std::span<const double> y);

}  // namespace abbe::standards
