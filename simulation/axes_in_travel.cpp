#include "simulation/axes_in_travel.h"

#include <fmt/format.h>

#include <algorithm>

#include "failure/failure.h"

namespace abbe::simulation {

Eigen::Matrix3Xd AxesInTravel(const machine::VolumetricModel& model, const Eigen::Matrix3Xd& axes,
                              const std::string& recording, const std::vector<std::size_t>& rows) {
  Eigen::Matrix3Xd held = axes;
  for (Eigen::Index i = 0; i < axes.cols(); ++i) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto& [first, last] = model.travels()[axis];
      held(axis, i) = std::clamp(axes(axis, i), first, last);
      if (std::abs(held(axis, i) - axes(axis, i)) <= kEndWindow) continue;
      throw InputError(
          fmt::format("{}: row {}: {} = {:.4f} mm lies outside the travel of the machine file, "
                      "{:g} to {:g} mm; "
                      "correct [axis.{}] travel_mm or leave these rows out",
                      recording, rows[i] + 1, "xyz"[axis], 1e3 * axes(axis, i), 1e3 * first,
                      1e3 * last, "XYZ"[axis]));
    }
  }
  return held;
}

}  // namespace abbe::simulation
