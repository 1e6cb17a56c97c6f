// What makes a map less certain beside the noise of its runs.
//
//   AddDoubt({.displacement = 1e-6}, model, -reference, covariance);
//
// Units: m, rad. Shapes: the covariance P x P, as that of a map.
// Failure: none.
// Source: own; simulation/doubt.h has the reasons.
// Validity: first order; both parts are taken as independent of the noise of the runs.
#pragma once

#include <Eigen/Core>

#include "map/error_map.h"

namespace abbe::fusion {

// Beside the noise of the runs (simulation/doubt.h).
struct Doubt {
  // The map may as well be this one: the difference counts as one standard uncertainty.
  const map::ErrorMap* other = nullptr;
  // m: standard deviation of an unknown displacement, rms over the travels and the components.
  double displacement = 0.0;
};

// Widens the covariance of the parameters of `found`; `tool`: m, of the tool point in T.
void AddDoubt(const Doubt& doubt, const machine::VolumetricModel& found,
              const Eigen::Vector3d& tool, Eigen::MatrixXd& covariance);

}  // namespace abbe::fusion
