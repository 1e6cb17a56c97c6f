#include "machine/volumetric_field.h"

#include <string>

namespace abbe::machine {
namespace {

using Eigen::Vector3d;

AxisMotions MotionsOf(const VolumetricModel& model, int axis) {
  std::array<ErrorFunction, kMotions> functions;
  for (int motion = 0; motion < kMotions; ++motion) {
    functions[motion] = model.Function(axis, motion);
  }
  return {axis, functions, model.travels()[axis]};
}

// exp(turn) v; for small turns without the matrix: sin(a)/a and (1 - cos(a))/a^2 by their series,
// which neglect a^8/9! < 3e-22.
Vector3d Turned(const Vector3d& turn, const Vector3d& v) {
  const double square = turn.squaredNorm();
  if (square >= 1e-4) return geometry::ExpRotation<double>(turn) * v;
  const double sine = 1 - square * (1.0 / 6 - square * (1.0 / 120 - square * (1.0 / 5040)));
  const double versine = 0.5 - square * (1.0 / 24 - square * (1.0 / 720 - square * (1.0 / 40320)));
  const Vector3d across = turn.cross(v);
  return v + sine * across + versine * turn.cross(across);
}

}  // namespace

VolumetricField::VolumetricField(const VolumetricModel& model)
    : chain_(model.chain()),
      lines_{LineOf<double>(0, model.squareness()), LineOf<double>(1, model.squareness()),
             LineOf<double>(2, model.squareness())},
      axes_{MotionsOf(model, 0), MotionsOf(model, 1), MotionsOf(model, 2)} {}

// The equations of volumetric_error.h: the tool point is transformed from carriage to carriage to
// the bed, then from the bed to the workpiece.
Vector3d VolumetricField::ErrorOf(const Vector3d& position, const Vector3d& p_TQ,
                                  const AxisErrors& errors) const {
  Vector3d p = p_TQ;
  const auto shift = [&](std::size_t axis) -> Vector3d {
    const double sense = chain_.CarriageSense("XYZ"[axis]);
    Vector3d way = errors[axis].head<3>() + sense * position[axis] * lines_[axis];
    if (sense < 0.0) way[axis] -= 2.0 * errors[axis][axis];
    return way;
  };
  const std::string& tool = chain_.tool_axes();
  for (auto letter = tool.rbegin(); letter != tool.rend(); ++letter) {
    const std::size_t axis = *letter - 'X';
    p = Turned(errors[axis].tail<3>(), p) + shift(axis);
  }
  const std::string& work = chain_.workpiece_axes();
  for (auto letter = work.rbegin(); letter != work.rend(); ++letter) {
    const std::size_t axis = *letter - 'X';
    p = Turned(-errors[axis].tail<3>(), p - shift(axis));
  }
  return p - NominalToolInWork<double>(chain_, position, p_TQ);
}

Vector3d VolumetricField::Error(const Vector3d& position, const Vector3d& p_TQ) const {
  return ErrorOf(position, p_TQ,
                 {axes_[0].At(position[0]), axes_[1].At(position[1]), axes_[2].At(position[2])});
}

Eigen::Matrix3Xd VolumetricField::Errors(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                         const Vector3d& p_TQ) const {
  Eigen::Matrix3Xd result(3, positions.cols());
  AxisErrors errors;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    for (int axis = 0; axis < kAxes; ++axis) {
      if (i > 0 && positions(axis, i) == positions(axis, i - 1)) continue;
      errors[axis] = axes_[axis].At(positions(axis, i));
    }
    result.col(i) = ErrorOf(positions.col(i), p_TQ, errors);
  }
  return result;
}

}  // namespace abbe::machine
