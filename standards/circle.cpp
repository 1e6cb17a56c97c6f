#include "standards/circle.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "failure/failure.h"
#include "standards/narrowest_annulus.h"

namespace abbe::standards {
namespace {

constexpr int kMaxSteps = 50;
// Convergence of the centre, relative to the radius.
constexpr double kSettled = 1e-13;

constexpr double kFullTurn = 2.0 * std::numbers::pi;
// Part of a turn; a longer gap between two neighbours was not measured.
constexpr double kGap = 0.05;

void CheckPoints(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 3) {
    throw InputError(
        fmt::format("circle through {} x and {} y: give both coordinates of at least three points",
                    x.size(), y.size()));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      throw InputError(
          fmt::format("circle, point {}: x = {}, y = {}: give finite numbers", i + 1, x[i], y[i]));
    }
  }
}

double Mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / values.size();
}

[[noreturn]] void ThrowLine(std::size_t n) {
  throw InputError(
      fmt::format("the {} points lie on a line or in one place and fix no circle; check which "
                  "columns hold the plane of the path",
                  n));
}

// The circle x^2 + y^2 + a x + b y + c = 0 by linear least squares, about the mean of the points.
Circle AlgebraicCircle(std::span<const double> x, std::span<const double> y) {
  const double mx = Mean(x), my = Mean(y);
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double square = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Vector2d p(x[i] - mx, y[i] - my);
    A += p * p.transpose();
    b += p * p.squaredNorm() / 2.0;
    square += p.squaredNorm();
  }
  constexpr double kFlat = 1e-20;  // squared ratio of the extents: rounding of points on a line
  if (!(A.determinant() > kFlat * A.trace() * A.trace())) ThrowLine(x.size());
  const Eigen::Vector2d c = A.inverse() * b;
  return {mx + c.x(), my + c.y(), std::sqrt(square / x.size() + c.squaredNorm())};
}

// One Gauss-Newton step of the radial deviations; returns how far the centre moved.
double StepLeastSquares(std::span<const double> x, std::span<const double> y,
                        std::span<const double> weights, Circle& circle) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - circle.x, dy = y[i] - circle.y;
    const double r = std::hypot(dx, dy);
    const Eigen::Vector3d g(dx / r, dy / r, 1.0);
    const double weight = weights.empty() ? 1.0 : weights[i];
    A += weight * g * g.transpose();
    b += weight * g * (r - circle.radius);
  }
  const Eigen::Vector3d step = A.ldlt().solve(b);
  circle = {circle.x + step.x(), circle.y + step.y(), circle.radius + step.z()};
  return step.head<2>().norm();
}

Circle LeastSquaresCircle(std::span<const double> x, std::span<const double> y,
                          std::span<const double> weights) {
  Circle circle = AlgebraicCircle(x, y);
  for (int step = 0; step < kMaxSteps; ++step) {
    if (StepLeastSquares(x, y, weights, circle) <= kSettled * circle.radius) return circle;
  }
  throw NumericalError(fmt::format(
      "least-squares circle of {} points: the centre did not converge in {} steps; is the path a "
      "circle?",
      x.size(), kMaxSteps));
}

Circle MinimumZoneCircle(std::span<const double> x, std::span<const double> y) {
  Circle circle = LeastSquaresCircle(x, y, {});
  std::vector<AnnulusPoint> points(x.size());
  for (int step = 0; step < kMaxSteps; ++step) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double dx = x[i] - circle.x, dy = y[i] - circle.y;
      const double r = std::hypot(dx, dy);
      points[i] = {dx / r, dy / r, r};
    }
    const Annulus zone = NarrowestAnnulus(points);
    circle = {circle.x + zone.x, circle.y + zone.y, (zone.outer + zone.inner) / 2.0};
    if (std::hypot(zone.x, zone.y) <= kSettled * circle.radius) return circle;
  }
  throw NumericalError(
      fmt::format("minimum-zone circle of {} points: the centre did not converge in {} steps; "
                  "are the deviations small compared with the radius?",
                  x.size(), kMaxSteps));
}

}  // namespace

std::vector<double> ArcsOf(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) {
    throw InputError(
        fmt::format("arcs of {} x and {} y: give both coordinates", x.size(), y.size()));
  }
  const std::size_t n = x.size();
  std::vector<double> angles(n);
  for (std::size_t i = 0; i < n; ++i) angles[i] = std::atan2(y[i], x[i]);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return angles[i]; });
  std::vector<double> steps(n);  // from each point, in the order of their angles, to the next
  for (std::size_t i = 0; i < n; ++i) {
    const double turned = angles[order[(i + 1) % n]] - angles[order[i]];
    steps[i] = i + 1 < n ? turned : turned + kFullTurn;
  }
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  for (double& step : steps) step = step > kGap * kFullTurn ? *middle : step;
  std::vector<double> arcs(n);
  for (std::size_t i = 0; i < n; ++i) arcs[order[i]] = (steps[i] + steps[(i + n - 1) % n]) / 2.0;
  return arcs;
}

Circle ReferenceCircle(CircleKind kind, std::span<const double> x, std::span<const double> y,
                       std::span<const double> weights) {
  CheckPoints(x, y);
  if (kind == CircleKind::kMinimumZone) return MinimumZoneCircle(x, y);
  if (!weights.empty() && weights.size() != x.size()) {
    throw InputError(
        fmt::format("circle through {} points with {} weights: give one for each, or none",
                    x.size(), weights.size()));
  }
  return LeastSquaresCircle(x, y, weights);
}

std::vector<double> RadialDeviations(const Circle& circle, std::span<const double> x,
                                     std::span<const double> y) {
  std::vector<double> deviations(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    deviations[i] = std::hypot(x[i] - circle.x, y[i] - circle.y) - circle.radius;
  }
  return deviations;
}

Roundness EvaluateRoundness(CircleKind kind, std::span<const double> x, std::span<const double> y,
                            std::span<const double> weights) {
  Roundness roundness{ReferenceCircle(kind, x, y, weights)};
  const std::vector<double> deviations = RadialDeviations(roundness.circle, x, y);
  double squares = 0.0, all = 0.0;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    roundness.peak = std::max(roundness.peak, deviations[i]);
    roundness.valley = std::max(roundness.valley, -deviations[i]);
    const double weight = weights.empty() ? 1.0 : weights[i];
    squares += weight * deviations[i] * deviations[i];
    all += weight;
  }
  roundness.rms = std::sqrt(squares / all);
  return roundness;
}

}  // namespace abbe::standards
