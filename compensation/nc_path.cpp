#include "compensation/nc_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compensation/nc_block.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Allowed difference in radius of the two ends of an arc, as in LinuxCNC for millimetres.
constexpr double kRadiusAbsolute = 0.5e-6, kRadiusRelative = 1e-3;

// rad: ends nearer than this are one place; rounding of offsets is 1e-15.
constexpr double kSameAngle = 1e-9;

// m: such an arc deviates from its chord by 1 um over 3 m.
constexpr double kLargestRadius = 1e6;

Vector2d CentreOfRadius(const Vector2d& a, const Vector2d& b, double radius, bool is_clockwise,
                        std::size_t line_number) {
  const Vector2d chord = b - a;
  const double half = chord.norm() / 2;
  if (half == 0.0) RefuseLine(line_number, "an arc with R and equal ends; give I, J or K");
  double height_square = radius * radius - half * half;
  if (height_square < 0.0) {
    // The ends may be beyond the diameter by rounding.
    if (half - std::abs(radius) > kRadiusAbsolute + kRadiusRelative * half) {
      RefuseLine(line_number,
                 fmt::format("R {:.6g} mm cannot reach over {:.6g} mm", 1e3 * radius, 2e3 * half));
    }
    height_square = 0.0;
  }
  const bool is_left = (radius > 0.0) != is_clockwise;
  const Vector2d left(-chord.y(), chord.x());
  return a + chord / 2 + (is_left ? 1 : -1) * std::sqrt(height_square) / (2 * half) * left;
}

int Count(double pieces, std::size_t line_number) {
  if (!(pieces < kMostLines)) {
    RefuseLine(
        line_number,
        fmt::format("the move would become {:.3g} lines; allow longer ones, or larger chords",
                    pieces));
  }
  return std::max(1, static_cast<int>(std::ceil(pieces - 1e-9)));
}

// An arc, or the spiral between ends of slightly different radius, with its rise.
struct Course {
  int u, v, w;
  Vector2d centre;
  double start, sweep;  // rad
  double r_a, r_b, z, rise;

  Vector3d At(double part) const {
    const double angle = start + part * sweep, radius = r_a + part * (r_b - r_a);
    Vector3d point;
    point[u] = centre.x() + radius * std::cos(angle);
    point[v] = centre.y() + radius * std::sin(angle);
    point[w] = z + part * rise;
    return point;
  }
};

Course CourseOf(const Vector3d& from, const Vector3d& to, const Arc& arc, std::size_t line_number) {
  const auto [u, v, w] = AxesOfPlane(arc.plane);
  const Vector2d a(from[u], from[v]), b(to[u], to[v]);
  const Vector2d centre = arc.radius
                              ? CentreOfRadius(a, b, *arc.radius, arc.is_clockwise, line_number)
                              : Vector2d(arc.centre[u], arc.centre[v]);
  const double r_a = (a - centre).norm(), r_b = (b - centre).norm();
  if (r_a == 0.0) RefuseLine(line_number, "an arc around its own start");
  if (!(std::max(r_a, r_b) < kLargestRadius)) {
    RefuseLine(line_number,
               fmt::format("an arc of radius {:.6g} mm; write a line (G1), or check I, "
                           "J, K and R",
                           1e3 * std::max(r_a, r_b)));
  }
  if (std::abs(r_a - r_b) > kRadiusAbsolute + kRadiusRelative * std::max(r_a, r_b)) {
    RefuseLine(line_number,
               fmt::format("the arc starts {:.6g} mm from its centre and ends {:.6g} mm "
                           "from it",
                           1e3 * r_a, 1e3 * r_b));
  }
  const double start = std::atan2(a.y() - centre.y(), a.x() - centre.x());
  double sweep = std::atan2(b.y() - centre.y(), b.x() - centre.x()) - start;
  constexpr double kTurn = 2 * std::numbers::pi;
  const double turn = arc.is_clockwise ? -kTurn : kTurn;
  if (sweep == 0.0 || (sweep > 0.0) == arc.is_clockwise) sweep += turn;
  if (std::abs(sweep) < kSameAngle) sweep += turn;
  sweep += turn * (arc.turns - 1.0);
  return {u, v, w, centre, start, sweep, r_a, r_b, from[w], to[w] - from[w]};
}

}  // namespace

std::array<int, 3> AxesOfPlane(int plane) {
  if (plane == 18) return {2, 0, 1};
  if (plane == 19) return {1, 2, 0};
  return {0, 1, 2};
}

void AddLine(const Vector3d& from, const Vector3d& to, const PathLimits& limits,
             std::size_t line_number, std::vector<Vector3d>& points) {
  const int count = Count((to - from).norm() / limits.length, line_number);
  for (int i = 1; i < count; ++i) {
    points.push_back(from + (to - from) * (static_cast<double>(i) / count));
  }
  points.push_back(to);
}

void AddArc(const Vector3d& from, const Vector3d& to, const Arc& arc, const PathLimits& limits,
            std::size_t line_number, std::vector<Vector3d>& points) {
  const Course course = CourseOf(from, to, arc, line_number);
  // 1 - cos(step / 2) = chord / radius
  const double chord = limits.chord / std::max(course.r_a, course.r_b);
  const double step = 4 * std::asin(std::sqrt(std::min(chord, 1.0) / 2));
  const int count =
      Count(std::max(std::abs(course.sweep) / step,
                     std::hypot(course.sweep * course.r_a, course.rise) / limits.length),
            line_number);
  for (int i = 1; i < count; ++i) points.push_back(course.At(static_cast<double>(i) / count));
  points.push_back(to);
}

double Sweep(const Vector3d& from, const Vector3d& to, const Arc& arc, std::size_t line_number) {
  return CourseOf(from, to, arc, line_number).sweep;
}

Arc WithCentre(const Vector3d& from, const Vector3d& to, const Arc& arc, std::size_t line_number) {
  const Course course = CourseOf(from, to, arc, line_number);
  Arc centred = arc;
  centred.radius.reset();
  centred.centre[course.u] = course.centre.x();
  centred.centre[course.v] = course.centre.y();
  return centred;
}

std::vector<Vector3d> Extremes(const Vector3d& from, const Vector3d& to, const Arc& arc,
                               std::size_t line_number) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const Course course = CourseOf(from, to, arc, line_number);
  std::vector<Vector3d> points{to};
  const double end = course.start + course.sweep;
  const double first = std::min(course.start, end);
  const double last = std::min(std::max(course.start, end), first + 2 * std::numbers::pi);
  for (double angle = kQuarter * std::ceil(first / kQuarter); angle < last; angle += kQuarter) {
    points.push_back(course.At((angle - course.start) / course.sweep));
  }
  return points;
}

}  // namespace abbe::compensation
