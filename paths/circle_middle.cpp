#include "paths/circle_middle.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "failure/located.h"
#include "standards/circle.h"

namespace abbe::paths {
namespace {

void SetMiddle(CircleRun& run, const Eigen::Vector2d& middle) {
  run.middle = middle;
  for (CirclePoint& point : run.points) {
    point.angle = std::atan2(point.second - middle.y(), point.first - middle.x());
  }
}

// The centre of an arc, with its radius held at the nominal one: an arc determines its radius, and
// with it its centre, badly.
void CentreArc(CircleRun& run) {
  constexpr int kRounds = 4;  // of Newton: each squares the relative error
  SetMiddle(run, Eigen::Vector2d::Zero());
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const CirclePoint& point : run.points) {
      const Eigen::Vector2d out(std::cos(point.angle), std::sin(point.angle));
      const double radius =
          (Eigen::Vector2d(point.first, point.second) - run.middle).norm() - run.radius;
      normal += out * out.transpose();
      right += out * radius;
    }
    SetMiddle(run, run.middle + normal.ldlt().solve(right));
  }
}

// Covered angles are about the centre, so the centre of a whole circle comes first; an arc is then
// centred as an arc.
void CentrePoints(CircleRun& run) {
  std::vector<double> first, second;
  for (const CirclePoint& point : run.points) {
    first.push_back(point.first);
    second.push_back(point.second);
  }
  const standards::Circle circle = Located(run.recordings.front(), [&] {
    return standards::ReferenceCircle(standards::CircleKind::kLeastSquares, first, second);
  });
  SetMiddle(run, {circle.x, circle.y});
  if (run.Partial()) CentreArc(run);
}

// A ballbar measures from its fixed ball, from where the commanded centre is seen at `middle`: not
// in the commanded direction u but in that of R u + middle. The difference is the square of the
// offset over the radius.
void TurnToFixedBall(CircleRun& run) {
  constexpr int kRounds = 3;  // the offset is known to a share of itself over the radius each time
  const std::vector<CirclePoint> read = run.points;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < read.size(); ++i) {
      const Eigen::Vector2d at(read[i].first, read[i].second);
      const Eigen::Vector2d seen =
          at.norm() * (run.radius * at.normalized() + run.middle).normalized();
      run.points[i].first = seen.x();
      run.points[i].second = seen.y();
    }
    CentrePoints(run);
  }
}

}  // namespace

void FindMiddle(CircleRun& run) {
  CentrePoints(run);
  if (run.instrument == kByBallbar) TurnToFixedBall(run);
}

}  // namespace abbe::paths
