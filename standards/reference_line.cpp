#include "standards/reference_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

struct Point {
  double x, y;
};

std::vector<Point> SortedPoints(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 2) {
    throw InputError(
        fmt::format("reference line of {} positions and {} deviations: give one of each for at "
                    "least two points",
                    x.size(), y.size()));
  }
  std::vector<Point> points(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      throw InputError(fmt::format("reference line, point {}: x = {}, y = {}: give finite numbers",
                                   i + 1, x[i], y[i]));
    }
    points[i] = {x[i], y[i]};
  }
  std::sort(points.begin(), points.end(), [](Point a, Point b) { return a.x < b.x; });
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].x == points[i - 1].x) {
      throw InputError(
          fmt::format("reference line: two points at x = {}: average the passes of a station first",
                      points[i].x));
    }
  }
  return points;
}

Line Through(Point a, Point b) {
  const double slope = (b.y - a.y) / (b.x - a.x);
  return {slope, a.y - slope * a.x};
}

Line LeastSquares(const std::vector<Point>& points) {
  const double n = points.size();
  Point mean{0, 0};
  for (const Point& point : points) mean = {mean.x + point.x / n, mean.y + point.y / n};
  double xx = 0, xy = 0;
  for (const Point& point : points) {
    xx += (point.x - mean.x) * (point.x - mean.x);
    xy += (point.x - mean.x) * (point.y - mean.y);
  }
  const double slope = xy / xx;
  return {slope, mean.y - slope * mean.x};
}

// The lower convex hull of points sorted by x: its edges' slopes ascend.
std::vector<Point> LowerHull(const std::vector<Point>& points) {
  std::vector<Point> hull;
  const auto turns_right = [](Point a, Point b, Point c) {
    return (b.x - a.x) * (c.y - a.y) <= (b.y - a.y) * (c.x - a.x);
  };
  for (const Point& point : points) {
    while (hull.size() >= 2 && turns_right(hull[hull.size() - 2], hull.back(), point))
      hull.pop_back();
    hull.push_back(point);
  }
  return hull;
}

Line MinimumZone(const std::vector<Point>& points) {
  const std::vector<Point> lower = LowerHull(points);
  std::vector<Point> mirrored = points;
  for (Point& point : mirrored) point.y = -point.y;
  std::vector<Point> upper = LowerHull(mirrored);
  for (Point& point : upper) point.y = -point.y;
  std::reverse(upper.begin(), upper.end());  // from right to left its edges' slopes ascend too

  // A band of ascending slope rests on lower[i] and under upper[j]. Each step turns it onto the
  // next edge of either hull; there its width may be the smallest.
  const auto slope_after = [](const std::vector<Point>& hull, std::size_t i) {
    return i + 1 < hull.size() ? Through(hull[i], hull[i + 1]).slope
                               : std::numeric_limits<double>::infinity();
  };
  Line best;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, j = 0; i + 1 < lower.size() || j + 1 < upper.size();) {
    const double below = slope_after(lower, i), above = slope_after(upper, j);
    const double slope = std::min(below, above);
    const double bottom = lower[i].y - slope * lower[i].x, top = upper[j].y - slope * upper[j].x;
    if (top - bottom < smallest) {
      smallest = top - bottom;
      best = {slope, (top + bottom) / 2};
    }
    below <= above ? ++i : ++j;
  }
  return best;
}

}  // namespace

Line ReferenceLine(LineKind kind, std::span<const double> x, std::span<const double> y) {
  const std::vector<Point> points = SortedPoints(x, y);
  switch (kind) {
    case LineKind::kEndPoints:
      return Through(points.front(), points.back());
    case LineKind::kLeastSquares:
      return LeastSquares(points);
    case LineKind::kMinimumZone:
      return MinimumZone(points);
  }
  return {};
}

}  // namespace abbe::standards
