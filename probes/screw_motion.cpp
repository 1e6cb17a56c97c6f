#include "probes/screw_motion.h"

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace abbe::probes {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

// The motions of `body` about the origin of H, 6 x screws, for 1 m of each of its screws.
MatrixXd MotionsOf(ScrewedBody body, const Eigen::Matrix3d& R_MH,
                   const std::vector<Screw>& screws) {
  MatrixXd motions = MatrixXd::Zero(6, static_cast<Eigen::Index>(screws.size()));
  std::vector<Eigen::Index> own;
  Vector3d centre = Vector3d::Zero();
  for (std::size_t i = 0; i < screws.size(); ++i) {
    if (screws[i].body != body) continue;
    own.push_back(static_cast<Eigen::Index>(i));
    centre += R_MH.transpose() * screws[i].place;
  }
  if (own.empty()) return motions;
  const auto count = static_cast<Eigen::Index>(own.size());
  centre /= static_cast<double>(count);
  MatrixXd supports(count, 6);
  double distance = 0.0;
  for (Eigen::Index row = 0; row < count; ++row) {
    const Screw& screw = screws[static_cast<std::size_t>(own[static_cast<std::size_t>(row)])];
    const Vector3d w = R_MH.transpose() * screw.direction;
    const Vector3d p = R_MH.transpose() * screw.place - centre;
    supports.row(row) << w.transpose(), p.cross(w).transpose();
    distance += p.norm() / static_cast<double>(count);
  }
  const double scale = distance > 0.0 ? 1.0 / distance : 1.0;
  supports.rightCols<3>() *= scale;
  MatrixXd about = supports.completeOrthogonalDecomposition().pseudoInverse();
  about.bottomRows<3>() *= scale;
  for (Eigen::Index column = 0; column < count; ++column) {
    const Vector3d turn = about.block<3, 1>(3, column);
    SmallMotion motion;
    motion << about.block<3, 1>(0, column) - turn.cross(centre), turn;
    motions.col(own[static_cast<std::size_t>(column)]) = motion;
  }
  return motions;
}

}  // namespace

ScrewMotion::ScrewMotion(const HeadLayout<>& layout, MovingBody moving, const Eigen::Matrix3d& R_MH,
                         const std::vector<Screw>& screws)
    : layout_(layout),
      way_(moving == MovingBody::kTarget ? -1.0 : 1.0),
      of_target_(MotionsOf(ScrewedBody::kTarget, R_MH, screws)),
      of_head_(MotionsOf(ScrewedBody::kHead, R_MH, screws)) {}

// The displacement of a body along the normals under the probes, whose places are `along` farther
// along u.
Eigen::Matrix<double, kProbes, 6> ScrewMotion::Reach(double along) const {
  Eigen::Matrix<double, kProbes, 6> reach;
  for (std::size_t i = 0; i < kProbes; ++i) {
    const bool top = i < kTopProbes;
    const Vector3d normal = top ? Vector3d::UnitZ() : Vector3d::UnitY();
    const Vector3d point =
        top ? Vector3d(layout_.top[i].u + along, layout_.top[i].s, 0.0)
            : Vector3d(layout_.side[i - kTopProbes].u + along, 0.0, layout_.side[i - kTopProbes].n);
    reach.row(static_cast<Eigen::Index>(i)) << normal.transpose(), point.cross(normal).transpose();
  }
  return reach;
}

Eigen::Matrix<double, kProbes, 6> ScrewMotion::OfTarget(double travel) const {
  return -Reach(way_ * travel);
}

ScrewResponse ScrewMotion::At(double travel) const {
  return OfTarget(travel) * of_target_ + Reach(0.0) * of_head_;
}

}  // namespace abbe::probes
