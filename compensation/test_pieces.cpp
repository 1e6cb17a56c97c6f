#include "compensation/test_pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "failure/failure.h"
#include "standards/circularity.h"
#include "standards/cylindricity.h"
#include "standards/diagonals.h"
#include "standards/straightness.h"

namespace abbe::compensation {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr const char* kMicrometre = "um";
constexpr const char* kMicroradian = "urad";

struct Plane {
  const char* name;
  int u, v;
};
constexpr std::array<Plane, 3> kPlanes = {{{"XY", 0, 1}, {"YZ", 1, 2}, {"ZX", 2, 0}}};

struct Span {
  std::string name;
  Vector3d from, to;
};

std::vector<Span> BodyDiagonals(const Volume& volume) {
  std::vector<Span> spans;
  for (const auto& [name, y, z] :
       {std::tuple{"+X+Y+Z", 1.0, 1.0}, std::tuple{"+X+Y-Z", 1.0, -1.0},
        std::tuple{"+X-Y+Z", -1.0, 1.0}, std::tuple{"+X-Y-Z", -1.0, -1.0}}) {
    const Vector3d half = volume.half.cwiseProduct(Vector3d(1.0, y, z));
    spans.push_back({name, volume.middle - half, volume.middle + half});
  }
  return spans;
}

constexpr Index kStations = 41;

// kStations points along each span, one span after the other.
Matrix3Xd Along(const std::vector<Span>& spans) {
  Matrix3Xd points(3, kStations * spans.size());
  for (Index i = 0; i < points.cols(); ++i) {
    const Span& span = spans[i / kStations];
    const double part = static_cast<double>(i % kStations) / (kStations - 1);
    points.col(i) = span.from + part * (span.to - span.from);
  }
  return points;
}

double RadiusOf(const Volume& volume, const TestSize& size) {
  for (int k = 0; k < 3; ++k) {
    if (volume.half[k] > 0.0) continue;
    throw InputError(fmt::format(
        "the machine has no axis {}, and this test piece has sides along X, Y and Z; take "
        "\"freeform\" with a path of the axes that are there",
        "XYZ"[k]));
  }
  const double radius = size.radius > 0.0 ? size.radius : 0.8 * volume.half.minCoeff();
  if (radius > volume.half.minCoeff()) {
    throw InputError(
        fmt::format("a radius of {:.6g} mm does not fit; the travels take up to {:.6g} mm",
                    1e3 * radius, 1e3 * volume.half.minCoeff()));
  }
  return radius;
}

// Coordinate k of `count` points from `first` on, relative to `origin`.
std::vector<double> Coordinates(const Matrix3Xd& made, Index first, Index count, int k,
                                double origin) {
  std::vector<double> values;
  values.reserve(count);
  for (Index i = first; i < first + count; ++i) values.push_back(made(k, i) - origin);
  return values;
}

}  // namespace

PerformanceTest Lengths(const Volume& volume, const TestSize& /*size*/) {
  std::vector<Span> spans;
  for (int k = 0; k < 3; ++k) {
    const Vector3d half = volume.half.cwiseProduct(Vector3d::Unit(k));
    spans.push_back({std::string(1, "XYZ"[k]), volume.middle - half, volume.middle + half});
  }
  for (const Span& diagonal : BodyDiagonals(volume)) spans.push_back(diagonal);
  return {Along(spans), [spans](const Matrix3Xd& made) {
            std::vector<Figure> figures;
            for (std::size_t s = 0; s < spans.size(); ++s) {
              const Index first = kStations * s;
              const double step = (spans[s].to - spans[s].from).norm() / (kStations - 1);
              const auto error = [&](Index i, Index j) {
                return (made.col(first + j) - made.col(first + i)).norm() - step * (j - i);
              };
              double largest = 0.0;
              for (Index i = 0; i < kStations; ++i) {
                for (Index j = i + 1; j < kStations; ++j) {
                  largest = std::max(largest, std::abs(error(i, j)));
                }
              }
              figures.push_back({"length " + spans[s].name, error(0, kStations - 1), kMicrometre});
              figures.push_back({"any length " + spans[s].name, largest, kMicrometre});
            }
            return figures;
          }};
}

PerformanceTest Circles(const Volume& volume, const TestSize& size) {
  constexpr Index kPoints = 360;
  const double radius = RadiusOf(volume, size);
  const Vector3d middle = volume.middle;
  Matrix3Xd wanted(3, 3 * kPoints);
  for (Index i = 0; i < wanted.cols(); ++i) {
    const Plane& plane = kPlanes[i / kPoints];
    const double t = 2 * std::numbers::pi * (i % kPoints) / kPoints;
    wanted.col(i) = middle;
    wanted(plane.u, i) += radius * std::cos(t);
    wanted(plane.v, i) += radius * std::sin(t);
  }
  return {wanted, [radius, middle](const Matrix3Xd& made) {
            std::vector<Figure> figures;
            for (Index p = 0; p < 3; ++p) {
              const auto& [name, u, v] = kPlanes[p];
              standards::CircularPaths paths;
              paths.radius = radius;
              paths.ccw.x = Coordinates(made, p * kPoints, kPoints, u, middle[u]);
              paths.ccw.y = Coordinates(made, p * kPoints, kPoints, v, middle[v]);
              const auto circle = standards::EvaluateCircularity(paths);
              figures.push_back({fmt::format("G {}", name), circle.ccw->G, kMicrometre});
              figures.push_back({fmt::format("F max {}", name), circle.F_max, kMicrometre});
              figures.push_back({fmt::format("F min {}", name), circle.F_min, kMicrometre});
            }
            return figures;
          }};
}

PerformanceTest Squares(const Volume& volume, const TestSize& size) {
  const double half = RadiusOf(volume, size);
  std::vector<Span> spans;  // for each plane: along u at -v and +v, along v at -u and +u
  for (const auto& [name, u, v] : kPlanes) {
    const Vector3d a = half * Vector3d::Unit(u), b = half * Vector3d::Unit(v);
    for (const double side : {-1.0, 1.0}) {
      spans.push_back({name, volume.middle + side * b - a, volume.middle + side * b + a});
    }
    for (const double side : {-1.0, 1.0}) {
      spans.push_back({name, volume.middle + side * a - b, volume.middle + side * a + b});
    }
  }
  return {Along(spans), [](const Matrix3Xd& made) {
            std::vector<Figure> figures;
            for (Index p = 0; p < 3; ++p) {
              const auto& [name, u, v] = kPlanes[p];
              std::array<double, 4> slopes;
              double straightness = 0.0;
              for (Index side = 0; side < 4; ++side) {
                const int along = side < 2 ? u : v, across = side < 2 ? v : u;
                const Index first = kStations * (4 * p + side);
                const auto line = standards::EvaluateStraightness(
                    standards::LineKind::kLeastSquares,
                    Coordinates(made, first, kStations, along, 0.0),
                    Coordinates(made, first, kStations, across, 0.0));
                straightness = std::max(straightness, line.error);
                slopes[side] = line.line.slope;
              }
              double squareness = 0.0;  // 90 deg minus the angle of the sides at a corner
              for (const double a : {slopes[0], slopes[1]}) {
                for (const double b : {slopes[2], slopes[3]}) {
                  if (std::abs(a + b) > std::abs(squareness)) squareness = a + b;
                }
              }
              figures.push_back({fmt::format("straightness {}", name), straightness, kMicrometre});
              figures.push_back({fmt::format("squareness {}", name), squareness, kMicroradian});
            }
            return figures;
          }};
}

PerformanceTest Cylinder(const Volume& volume, const TestSize& size) {
  constexpr Index kAngles = 72, kHeights = 9;
  const double radius = RadiusOf(volume, size);
  Matrix3Xd wanted(3, kAngles * kHeights);
  for (Index i = 0; i < wanted.cols(); ++i) {
    const double t = 2 * std::numbers::pi * (i % kAngles) / kAngles;
    const Index level = i / kAngles;
    const double height = 2.0 * level / (kHeights - 1) - 1.0;
    wanted.col(i) = volume.middle +
                    Vector3d(radius * std::cos(t), radius * std::sin(t), height * volume.half.z());
  }
  return {wanted, [radius](const Matrix3Xd& made) -> std::vector<Figure> {
            const auto fit = standards::EvaluateCylindricity(made);
            return {{"cylindricity", fit.error, kMicrometre},
                    {"diameter", 2 * (fit.radius - radius), kMicrometre},
                    {"tilt of the axis", fit.tilt.norm(), kMicroradian}};
          }};
}

PerformanceTest Freeform(const Volume& /*volume*/, const TestSize& size) {
  if (size.path.cols() == 0)
    throw InputError("a freeform test needs its path; give it with --path FILE");
  const Matrix3Xd wanted = size.path;
  return {wanted, [wanted](const Matrix3Xd& made) -> std::vector<Figure> {
            const Eigen::VectorXd distances = (made - wanted).colwise().norm();
            return {{"largest", distances.maxCoeff(), kMicrometre},
                    {"rms", std::sqrt(distances.squaredNorm() / distances.size()), kMicrometre}};
          }};
}

PerformanceTest Diagonals(const Volume& volume, const TestSize& /*size*/) {
  const std::vector<Span> spans = BodyDiagonals(volume);
  return {Along(spans), [spans](const Matrix3Xd& made) {
            std::vector<Figure> figures;
            std::vector<standards::DiagonalRuns> runs(spans.size());
            for (std::size_t s = 0; s < spans.size(); ++s) {
              const Vector3d direction = (spans[s].to - spans[s].from).normalized();
              const Index first = kStations * s;
              const double step = (spans[s].to - spans[s].from).norm() / (kStations - 1);
              for (Index i = 0; i < kStations; ++i) {
                runs[s].forward.push_back(direction.dot(made.col(first + i) - made.col(first)) -
                                          step * i);
              }
              runs[s].backward = runs[s].forward;
              figures.push_back(
                  {"E " + spans[s].name, standards::EvaluateDiagonal(runs[s]).E, kMicrometre});
            }
            const auto machine = standards::EvaluateDiagonals(runs);
            figures.push_back({"E_d", machine.E, kMicrometre});
            figures.push_back({"B_d", machine.B, kMicrometre});
            return figures;
          }};
}

}  // namespace abbe::compensation
