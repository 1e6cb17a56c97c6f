#include "fusion/reversal_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Where triangles have their peaks, in widths, and one knot more on either side: for one end of an
// axis in one run, and for both ends in all runs.
constexpr std::array kKnots{-0.5, 0.0, 0.5, 1.0, 2.0, 3.5, 6.0};
constexpr std::array kKnotsOfAll{-0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.4,
                                 1.8,   2.3, 2.8,  3.4, 4.0,  5.0, 6.0};
constexpr double kFormKnownTo = 0.25;  // of the size
constexpr Index kTriangles = kKnots.size() - 2, kOfAxis = 1 + 2 * kTriangles;
constexpr Index kTrianglesOfAll = kKnotsOfAll.size() - 2;

// Where the axis last turned: the angle gone since, and at which of its two ends.
struct Since {
  double angle;
  int end;  // 1: positive, -1
};
Since SinceReversal(const paths::CirclePoint& point, int axis) {
  constexpr double kPi = std::numbers::pi;
  const double turned = point.sense * (point.angle - (axis == 0 ? 0.0 : kPi / 2.0));
  const double halves = std::floor(turned / kPi);
  return {turned - kPi * halves, std::fmod(halves, 2.0) == 0.0 ? 1 : -1};
}

// 1 at knot `peak`, 0 at its neighbours and beyond.
double Triangle(double widths, std::span<const double> knots, std::size_t peak) {
  const double before = knots[peak - 1], at = knots[peak], after = knots[peak + 1];
  return std::max(0.0,
                  std::min((widths - before) / (at - before), (after - widths) / (after - at)));
}

}  // namespace

MatrixXd ShapesOf(const paths::CircleRun& run, const MatrixXd& spikes,
                  const AfterReversals& after) {
  MatrixXd shapes = MatrixXd::Zero(spikes.rows(), 2 * kOfAxis);
  for (int axis = 0; axis < 2; ++axis) {
    const double size = after.size[axis];
    if (size == 0.0) continue;
    for (Index i = 0; i < shapes.rows(); ++i) {
      const Since since = SinceReversal(run.points[i], axis);
      shapes(i, axis * kOfAxis) = kSpikeBetween * size * since.end * spikes(i, axis);
      const Index first = axis * kOfAxis + (since.end > 0 ? 1 : 1 + kTriangles);
      for (Index peak = 0; peak < kTriangles; ++peak) {
        shapes(i, first + peak) =
            kFormKnownTo * size * Triangle(since.angle / after.width[axis], kKnots, peak + 1);
      }
    }
  }
  return shapes;
}

MatrixXd ShapesAlike(const paths::CircleRun& run, const AfterReversals& after) {
  MatrixXd alike = MatrixXd::Zero(std::ssize(run.points), 2 * kTrianglesOfAll);
  for (int axis = 0; axis < 2; ++axis) {
    const double size = after.size[axis];
    if (size == 0.0) continue;
    for (Index i = 0; i < alike.rows(); ++i) {
      const double widths = SinceReversal(run.points[i], axis).angle / after.width[axis];
      for (Index peak = 0; peak < kTrianglesOfAll; ++peak) {
        alike(i, axis * kTrianglesOfAll + peak) =
            kFormKnownTo * size * Triangle(widths, kKnotsOfAll, peak + 1);
      }
    }
  }
  return alike;
}

MatrixXd SpikesBetweenRuns(const MatrixXd& spikes, std::size_t at, std::size_t runs,
                           const AfterReversals& after) {
  const Index others = static_cast<Index>(runs) - 1;
  MatrixXd between = MatrixXd::Zero(spikes.rows(), 2 * others);
  for (Index axis = 0; axis < 2; ++axis) {
    const double size = kSpikeBetween * after.size[axis];
    for (Index other = 0; other < others; ++other) {
      // All others have one of their own, the last what makes the sum nothing.
      const double share = static_cast<Index>(at) == others  ? -1.0
                           : static_cast<Index>(at) == other ? 1.0
                                                             : 0.0;
      between.col(axis * others + other) = share * size * spikes.col(axis);
    }
  }
  return between;
}

}  // namespace abbe::fusion
