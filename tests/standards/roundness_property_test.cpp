#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "standards/articulation.h"
#include "standards/circle.h"

namespace abbe::standards {
namespace roundness_property_test {

constexpr double kRadius = 10.0;
using Point = Eigen::Vector2d;

// Points around a circle of 10 with deviations of up to 0.01, in steps of 0.0001.
std::vector<Point> AnyPath() {
  const int n = *rc::gen::inRange(5, 13);
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * (i + 0.0008 * *rc::gen::inRange(-500, 500)) / n;
    const double r = kRadius + 1e-4 * *rc::gen::inRange(-100, 101);
    points.emplace_back(r * std::cos(t), r * std::sin(t));
  }
  return points;
}

double WidthAbout(const Point& centre, const std::vector<Point>& points) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Point& p : points) {
    low = std::min(low, (p - centre).norm());
    high = std::max(high, (p - centre).norm());
  }
  return high - low;
}

// The point as far from a as from b and as far from c as from d.
std::optional<Point> Centre(const Point& a, const Point& b, const Point& c, const Point& d) {
  Eigen::Matrix2d A;
  A << (b - a).transpose(), (d - c).transpose();
  if (std::abs(A.determinant()) < 1e-12) return std::nullopt;
  const Point rhs((b.squaredNorm() - a.squaredNorm()) / 2, (d.squaredNorm() - c.squaredNorm()) / 2);
  return A.inverse() * rhs;
}

// All centres at which two pairs of points are equally far: the exact optimum, not linearised, is
// among them (two on each circle), or among the centres of three points (a = c).
double NarrowestZone(const std::vector<Point>& points) {
  double best = std::numeric_limits<double>::infinity();
  const std::size_t n = points.size();
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      for (std::size_t c = a; c < n; ++c) {
        for (std::size_t d = c + 1; d < n; ++d) {
          const auto centre = Centre(points[a], points[b], points[c], points[d]);
          if (centre && centre->norm() < kRadius / 2) {
            best = std::min(best, WidthAbout(*centre, points));
          }
        }
      }
    }
  }
  return best;
}

RC_GTEST_PROP(CircleProperty, MinimumZoneIsTheNarrowestOfAll, ()) {
  const std::vector<Point> points = AnyPath();
  std::vector<double> x, y;
  for (const Point& p : points) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
  const Roundness zone = EvaluateRoundness(CircleKind::kMinimumZone, x, y);
  const Roundness squares = EvaluateRoundness(CircleKind::kLeastSquares, x, y);
  constexpr double kRounding = 1e-11;  // of radii of 10, through a 4 x 4 system of condition 1e3
  RC_ASSERT(std::abs(zone.Error() - NarrowestZone(points)) <= kRounding);
  RC_ASSERT(zone.Error() <= squares.Error() + kRounding);
  RC_ASSERT(std::abs(zone.peak - zone.valley) <= kRounding);
}

// The least-squares centre: no small step makes the sum of squares smaller.
RC_GTEST_PROP(CircleProperty, LeastSquaresIsAMinimum, ()) {
  const std::vector<Point> points = AnyPath();
  std::vector<double> x, y;
  for (const Point& p : points) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
  const Circle circle = ReferenceCircle(CircleKind::kLeastSquares, x, y);
  const auto squares = [&](double dx, double dy, double dr) {
    double sum = 0;
    const Circle moved{circle.x + dx, circle.y + dy, circle.radius + dr};
    for (const double one : RadialDeviations(moved, x, y)) sum += one * one;
    return sum;
  };
  constexpr double kStep = 1e-5;
  const double least = squares(0, 0, 0);
  for (const double step : {kStep, -kStep}) {
    RC_ASSERT(squares(step, 0, 0) > least);
    RC_ASSERT(squares(0, step, 0) > least);
    RC_ASSERT(squares(0, 0, step) > least);
  }
}

// Smallest sphere by its law: it holds all points, and its centre lies in the hull of those on its
// surface: no direction has all of them behind it.
RC_GTEST_PROP(ArticulationProperty, TheSphereIsTheSmallest, ()) {
  const int n = *rc::gen::inRange(2, 40);
  Eigen::Matrix3Xd p(3, n);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) p(k, i) = *rc::gen::inRange(-20, 21);
  }
  const Sphere sphere = SmallestEnclosingSphere(p);
  constexpr double kRounding = 1e-11;
  std::vector<Eigen::Vector3d> on;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d arm = p.col(i) - sphere.centre;
    RC_ASSERT(arm.norm() <= sphere.radius + kRounding);
    if (arm.norm() >= sphere.radius - 1e-9) on.push_back(arm);
  }
  for (int try_number = 0; try_number < 20; ++try_number) {
    const Eigen::Vector3d direction(*rc::gen::inRange(-50, 51), *rc::gen::inRange(-50, 51),
                                    *rc::gen::inRange(-50, 51));
    double furthest = -1;
    for (const Eigen::Vector3d& arm : on) furthest = std::max(furthest, arm.dot(direction));
    RC_ASSERT(furthest >= -1e-9 * (1 + direction.norm()) * (1 + sphere.radius));
  }
}

}  // namespace roundness_property_test
}  // namespace abbe::standards
