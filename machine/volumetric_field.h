// Fast evaluation of the volumetric error of a constant machine error model: the same numbers to
// rounding, without derivatives, an order of magnitude faster.
//
//   const VolumetricField field(model);
//   const Eigen::Vector3d error = field.Error({0.03, 0.02, 0.05}, p_TQ);
//   const Eigen::Matrix3Xd errors = field.Errors(positions, p_TQ);
//
// Frames, signs, units, shapes: volumetric_model.h. The motions of each axis come from
// axis_motions.h, its line is computed once, and Errors() reuses the motions of the axes that do
// not move from one position to the next.
// Units: m, rad. Shapes: positions and errors in columns, 3 x N.
// Failure: InputError for a position outside a travel, naming axis and travel.
// Source: as volumetric_error.h, whose result it repeats to rounding.
// Validity: a copy of the model at construction.
#pragma once

#include <Eigen/Core>
#include <array>

#include "machine/axis_motions.h"
#include "machine/volumetric_model.h"

namespace abbe::machine {

class VolumetricField {
 public:
  explicit VolumetricField(const VolumetricModel& model);

  // The error at one position.
  Eigen::Vector3d Error(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ) const;
  // At many; fastest where only one axis moves from one to the next.
  Eigen::Matrix3Xd Errors(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                          const Eigen::Vector3d& p_TQ) const;

 private:
  using AxisErrors = std::array<geometry::ErrorVector<double>, kAxes>;
  Eigen::Vector3d ErrorOf(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ,
                          const AxisErrors& errors) const;

  Chain chain_;
  std::array<Eigen::Vector3d, kAxes> lines_;
  std::array<AxisMotions, kAxes> axes_;
};

}  // namespace abbe::machine
