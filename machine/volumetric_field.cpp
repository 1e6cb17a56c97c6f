#include "machine/volumetric_field.h"

namespace abbe::machine {
namespace {

using Eigen::Vector3d;

AxisMotions MotionsOf(const VolumetricModel& model, int axis) {
  std::array<ErrorFunction, kMotions> functions;
  for (int motion = 0; motion < kMotions; ++motion) {
    functions[static_cast<std::size_t>(motion)] = model.Function(axis, motion);
  }
  return {axis, functions, model.travels()[static_cast<std::size_t>(axis)]};
}

}  // namespace

VolumetricField::VolumetricField(const VolumetricModel& model)
    : chain_(model.chain()),
      lines_(LinesOf<double>(model.squareness())),
      axes_{MotionsOf(model, 0), MotionsOf(model, 1), MotionsOf(model, 2)} {}

Vector3d VolumetricField::ErrorOf(const Vector3d& position, const Vector3d& p_TQ,
                                  const AxisErrors<double>& errors) const {
  return ToolInWork<double>(chain_, lines_, position, p_TQ, errors) -
         NominalToolInWork<double>(chain_, position, p_TQ);
}

Vector3d VolumetricField::Error(const Vector3d& position, const Vector3d& p_TQ) const {
  return ErrorOf(position, p_TQ,
                 {axes_[0].At(position[0]), axes_[1].At(position[1]), axes_[2].At(position[2])});
}

Eigen::Matrix3Xd VolumetricField::Errors(const Eigen::Matrix3Xd& positions,
                                         const Vector3d& p_TQ) const {
  Eigen::Matrix3Xd result(3, positions.cols());
  AxisErrors<double> errors;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    for (int axis = 0; axis < kAxes; ++axis) {
      if (i > 0 && positions(axis, i) == positions(axis, i - 1)) continue;
      const auto at = static_cast<std::size_t>(axis);
      errors[at] = axes_[at].At(positions(axis, i));
    }
    result.col(i) = ErrorOf(positions.col(i), p_TQ, errors);
  }
  return result;
}

}  // namespace abbe::machine
