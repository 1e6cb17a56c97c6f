#include "simulation/trace.h"

#include "simulation/trace_columns.h"
#include "simulation/trace_motion.h"

namespace abbe::simulation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

RowVectorXd Trace::BacklashLag(int which, double width) const {
  if (width <= 0.0) return -0.5 * heading.row(which);
  return BacklashLag(which, [&](double) { return width; });
}

RowVectorXd Trace::BacklashLag(int which, const WidthAt& width) const {
  const bool follows = on_the_way == OnTheWay::kAlways ||
                       (on_the_way == OnTheWay::kWhileMoving && !velocity.row(which).isZero(0.0));
  if (!follows) return -0.5 * heading.row(which);
  return PlayOf(axes.row(which), *this, width);
}

RowVectorXd Trace::PivotBacklashLag(int pivot, double width) const {
  if (width == 0.0) return -0.5 * linkage->heading.row(pivot);
  if (width < 0.0) {
    return LaggingPlayOf(linkage->angles.row(pivot), linkage->heading.row(pivot), *this, -width);
  }
  const MatrixXd& aside = linkage->angle_bulge;
  return ShownPlayOf(
      linkage->angles.row(pivot), *this, width,
      aside.size() > 0 ? aside.middleRows(pivot * kWaySteps, kWaySteps) : MatrixXd{});
}

void Trace::SetAxes(const Eigen::Matrix3Xd& path) {
  axes = path;
  const Derivatives motion = DerivativesOf(axes, *this);
  velocity = motion.first;
  acceleration = motion.second;
  heading.resize(3, axes.cols());
  since_reversal.resize(3, axes.cols());
  for (Index i = 0; i < 3; ++i) {
    heading.row(i) = "XYZ"[i] == axis ? ApproachOf(direction) : HeadingOfAxis(*this, i);
    since_reversal.row(i) = SinceReversal(*this, i);
  }
}

void Trace::SetAngles(const MatrixXd& angles) {
  constexpr double kPivotBand = 50e-6;  // rad: more than an encoder trembles
  if (!linkage) linkage.emplace();
  linkage->angles = angles;
  linkage->heading.resize(angles.rows(), angles.cols());
  for (Index pivot = 0; pivot < angles.rows(); ++pivot) {
    linkage->heading.row(pivot) = HeadingOf(angles.row(pivot), kPivotBand);
  }
}

Disturbance NoDisturbance(const Trace& trace) { return Disturbance(trace.rows()); }

}  // namespace abbe::simulation
