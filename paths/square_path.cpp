#include "paths/square_path.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::paths {
namespace {

constexpr double kOnSide = 20e-6;      // m: largest distance of a commanded position from its side
constexpr double kCorner = 0.02;       // of a side, left out at each end: the axes change there
constexpr double kLeastOnSides = 0.5;  // of the rows
constexpr int kPieces = 100;           // of a side, averaged each

struct Rectangle {
  int first, second;          // axes
  Eigen::Vector3d low, high;  // corners
};

// A circle touches the rectangle around it too.
void RefuseOffSides(const MeasuredPath& path, const Rectangle& box) {
  Eigen::Index on = 0;
  for (Eigen::Index i = 0; i < path.poses(); ++i) {
    double off = kOnSide;
    for (const int axis : {box.first, box.second}) {
      const double place = path.commanded(axis, i);
      off = std::min({off, place - box.low[axis], box.high[axis] - place});
    }
    if (off < kOnSide) ++on;
  }
  const double part = on / static_cast<double>(path.poses());
  if (part >= kLeastOnSides) return;
  throw InputError(fmt::format(
      "{}: {:.0f} % of the rows lie on the sides of the rectangle around the commanded path: a "
      "square path runs along them; abbe circle takes circles, --test FILE any other path",
      path.recording, 100.0 * part));
}

Rectangle CommandedRectangle(const MeasuredPath& path) {
  Rectangle rectangle{0, 1, path.commanded.rowwise().minCoeff(),
                      path.commanded.rowwise().maxCoeff()};
  const Eigen::Vector3d size = rectangle.high - rectangle.low;
  Eigen::Index thin = 0;
  const double thickness = size.minCoeff(&thin);
  rectangle.first = thin == 0 ? 1 : 0;
  rectangle.second = thin == 2 ? 1 : 2;
  if (thickness > kOnSide || size[rectangle.first] < kOnSide || size[rectangle.second] < kOnSide) {
    throw InputError(fmt::format(
        "{}: the commanded path fills {:.3f} x {:.3f} x {:.3f} mm: a square path has two of these "
        "and no third",
        path.recording, size.x() * 1e3, size.y() * 1e3, size.z() * 1e3));
  }
  RefuseOffSides(path, rectangle);
  return rectangle;
}

struct Piece {
  double along = 0.0, across = 0.0;
  int count = 0;
};

// One side: along `axis`, at `place` of `other`.
SquareSide SideOf(const MeasuredPath& path, const Rectangle& box, int axis, int other, bool high) {
  const double place = high ? box.high[other] : box.low[other];
  const double length = box.high[axis] - box.low[axis];
  const Eigen::Vector3d centre = (box.low + box.high) / 2.0;
  std::array<Piece, kPieces> pieces{};
  for (Eigen::Index i = 0; i < path.poses(); ++i) {
    const double part = (path.commanded(axis, i) - box.low[axis]) / length;
    if (std::abs(path.commanded(other, i) - place) > kOnSide) continue;
    if (part < kCorner || part > 1.0 - kCorner) continue;
    Piece& piece = pieces[static_cast<std::size_t>(part * kPieces)];
    piece.along += path.measured(axis, i) - centre[axis];
    piece.across += path.measured(other, i) - path.commanded(other, i);
    ++piece.count;
  }
  SquareSide side{"XYZ" [axis], {}, {}, {}, {}};
  side.nominal = length;
  for (const Piece& piece : pieces) {
    if (piece.count == 0) continue;
    side.along.push_back(piece.along / piece.count);
    side.across.push_back(piece.across / piece.count);
  }
  if (side.along.size() < 3) {
    throw InputError(
        fmt::format("{}: {} pieces of the side along {} at {} = {:.3f} mm have points: a square "
                    "path runs along "
                    "all four sides",
                    path.recording, side.along.size(), "XYZ"[axis], "XYZ"[other], place * 1e3));
  }
  side.least_squares =
      standards::EvaluateStraightness(standards::LineKind::kLeastSquares, side.along, side.across);
  side.minimum_zone =
      standards::EvaluateStraightness(standards::LineKind::kMinimumZone, side.along, side.across);
  return side;
}

// Where a line along the first axis, second = a.offset + half_a + a.slope first, meets one along
// the second axis.
Eigen::Vector2d Corner(const standards::Line& a, double place_a, const standards::Line& b,
                       double place_b) {
  Eigen::Matrix2d A;
  A << -a.slope, 1.0, 1.0, -b.slope;
  return A.inverse() * Eigen::Vector2d(place_a + a.offset, place_b + b.offset);
}

}  // namespace

SquareFigures EvaluateSquare(const MeasuredPath& path) {
  const Rectangle box = CommandedRectangle(path);
  const int first = box.first, second = box.second;
  SquareFigures figures{
      {"XYZ"[first], "XYZ"[second]},
      {SideOf(path, box, first, second, false), SideOf(path, box, second, first, true),
       SideOf(path, box, first, second, true), SideOf(path, box, second, first, false)},
      {}};
  const double half_first = (box.high[first] - box.low[first]) / 2.0;
  const double half_second = (box.high[second] - box.low[second]) / 2.0;
  const auto& [lower, right, upper, left] = figures.sides;
  const auto line = [](const SquareSide& side) { return side.least_squares.line; };
  const std::array<Eigen::Vector2d, 4> corners{
      Corner(line(lower), -half_second, line(right), half_first),
      Corner(line(upper), half_second, line(right), half_first),
      Corner(line(upper), half_second, line(left), -half_first),
      Corner(line(lower), -half_second, line(left), -half_first)};
  for (std::size_t i = 0; i < 4; ++i) {
    figures.sides[i].length = (corners[i] - corners[(i + 3) % 4]).norm();
    // The direction of the side along the first axis turns by its slope, that along the second by
    // minus its slope; the angle inside grows and shrinks from corner to corner.
    const SquareSide& one = figures.sides[i];
    const SquareSide& next = figures.sides[(i + 1) % 4];
    const double sum = std::atan(line(one).slope) + std::atan(line(next).slope);
    figures.corners[i] = i % 2 == 0 ? sum : -sum;
  }
  return figures;
}

}  // namespace abbe::paths
