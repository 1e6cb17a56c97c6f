#include "machine/volumetric_jacobian.h"

#include <cstddef>

namespace abbe::machine {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;
using geometry::Transform;

// Adds the derivatives by the motions and position of one carriage. side: +1 on the tool side, -1
// on the workpiece side; sense: its CarriageSense.
void AddCarriage(int axis, double side, double sense, const Matrix3d& R_Wa, const Vector3d& arm,
                 double q, const MotionErrors<double>& errors, VolumetricJacobian& out) {
  const Vector3d turn = errors.axes[axis].tail<3>();
  const Matrix3d R = side * R_Wa;
  out.J_error_motions.middleCols<3>(kMotions * axis) = R;
  out.J_error_motions.col(kMotions * axis + axis) *= sense;
  out.J_error_motions.middleCols<3>(kMotions * axis + 3) =
      -R * geometry::Skew<double>(arm) * geometry::ExpRotationJacobian<double>(turn);
  out.J_error_squareness += sense * q * R * LineJacobian(axis, errors.squareness);
  out.J_error_position.col(axis) =
      sense * (R * LineOf<double>(axis, errors.squareness) - side * Vector3d::Unit(axis));
}

}  // namespace

Matrix3d LineJacobian(int axis, const Vector3d& squareness) {
  const Matrix3d J = -geometry::Skew<double>(LineOf<double>(axis, squareness)) *
                     geometry::ExpRotationJacobian<double>(LineTurn<double>(axis, squareness));
  Matrix3d by_squareness = Matrix3d::Zero();
  if (axis == 1) by_squareness.col(2) = J.col(2);
  if (axis == 2) by_squareness.leftCols<2>() = J.leftCols<2>();
  return by_squareness;
}

VolumetricJacobian VolumetricErrorAndJacobian(const Chain& chain, const Vector3d& position,
                                              const Vector3d& p_TQ,
                                              const MotionErrors<double>& errors) {
  const std::string& tool = chain.tool_axes();
  const std::string work(chain.workpiece_axes().rbegin(), chain.workpiece_axes().rend());
  const Transform<double> X_WM = BodyPose<double>(chain, work, position, errors).Inverse();
  const Vector3d p_MQ = BodyPose<double>(chain, tool, position, errors) * p_TQ;
  VolumetricJacobian out;
  out.J_error_motions.setZero();  // of axes that the chain lacks
  out.J_error_position.setZero();
  out.error = X_WM * p_MQ - NominalToolInWork<double>(chain, position, p_TQ);
  out.J_error_squareness.setZero();

  const auto walk = [&](const std::string& axes_from_bed, double side) {
    Matrix3d R_Wa = X_WM.R;
    Vector3d p_aQ = p_MQ;
    for (const char letter : axes_from_bed) {
      const int axis = letter - 'X';
      const double sense = chain.CarriageSense(letter);
      const auto X_ab = CarriagePose<double>(axis, sense, position[axis], errors);
      AddCarriage(axis, side, sense, R_Wa, p_aQ - X_ab.p, position[axis], errors, out);
      p_aQ = X_ab.Inverse() * p_aQ;
      R_Wa = R_Wa * X_ab.R;
    }
    return R_Wa;
  };
  walk(work, -1.0);
  out.J_error_tool = walk(tool, 1.0) - Matrix3d::Identity();
  return out;
}

}  // namespace abbe::machine
