#include "volumetric_cases.h"

#include <ceres/jet.h>

namespace abbe::machine {

Eigen::Vector3d FirstOrderError(const Chain& chain, const Eigen::Vector3d& position,
                                const Eigen::Vector3d& p_TQ, const MotionErrors<double>& errors) {
  using Jet = ceres::Jet<double, 1>;
  const Jet size(0.0, 0);
  MotionErrors<Jet> grown;
  for (int axis = 0; axis < kAxes; ++axis) grown.axes[axis] = errors.axes[axis].cast<Jet>() * size;
  grown.squareness = errors.squareness.cast<Jet>() * size;
  const Eigen::Vector3<Jet> error =
      VolumetricError<Jet>(chain, position.cast<Jet>(), p_TQ.cast<Jet>(), grown);
  return {error[0].v[0], error[1].v[0], error[2].v[0]};
}

}  // namespace abbe::machine
