#include "rig/target_screws.h"

#include <fmt/format.h>

#include <Eigen/QR>

namespace abbe::rig {
namespace {

constexpr int kNewtonSteps = 6;

Displacement InverseOf(const Displacement& displacement) {
  const Eigen::Matrix3d back = displacement.rotation.transpose();
  return {back, -(back * displacement.translation)};
}

}  // namespace

TargetScrews::TargetScrews(const RigSettings& settings, const Eigen::Vector3d& corner)
    : screws_(settings.screws), moved_(screws_.size(), 0.0), corner_(corner) {}

void TargetScrews::Turn(std::string_view name, double turns) {
  for (std::size_t i = 0; i < screws_.size(); ++i) {
    if (screws_[i].name != name) continue;
    if (screws_[i].pitch == 0.0) {
      throw InputError(fmt::format("{} is a fixed support: its pitch_mm is 0", name));
    }
    moved_[i] += turns * screws_[i].pitch;
    Settle();
    return;
  }
  throw InputError(fmt::format(
      "the target has no screw \"{}\"; name one of the tables [align.screw.NAME]", name));
}

void TargetScrews::MountAt(const Eigen::Vector3d& corner) {
  corner_ = corner;
  Settle();
}

void TargetScrews::Settle() {
  seat_ = {};
  const auto count = static_cast<Eigen::Index>(screws_.size());
  if (count == 0) return;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const TargetScrew& screw : screws_) centre += (corner_ + screw.place) / screws_.size();
  double reach = 1e-3;
  for (const TargetScrew& screw : screws_) {
    reach = std::max(reach, (corner_ + screw.place - centre).norm());
  }
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Displacement back = InverseOf(seat_);
    Eigen::MatrixXd slopes(count, 6);
    Eigen::VectorXd missed(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const TargetScrew& screw = screws_[static_cast<std::size_t>(i)];
      const Eigen::Vector3d support = corner_ + screw.place;
      const Eigen::Vector3d tip =
          back * (support + moved_[static_cast<std::size_t>(i)] * screw.direction);
      missed[i] = screw.direction.dot(tip - support);
      slopes.row(i) << screw.direction.transpose(),
          (tip - centre).cross(screw.direction).transpose() / reach;
    }
    const Eigen::VectorXd motion = slopes.completeOrthogonalDecomposition().solve(missed);
    const Eigen::Matrix3d turn = FullRotation(Eigen::Vector3d(motion.tail<3>() / reach));
    const Eigen::Vector3d shift = motion.head<3>();
    seat_ = seat_ * Displacement{turn, shift + centre - turn * centre};
  }
}

}  // namespace abbe::rig
