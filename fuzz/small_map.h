// A map of 300 mm of travel with some errors, for targets that need one.
#pragma once

#include "machine/standard_forms.h"
#include "map/error_map.h"

namespace abbe::fuzz {

inline map::ErrorMap SmallMap() {
  const machine::Travel travel{0.0, 0.3};
  machine::VolumetricModel model(machine::Chain::Parse("[w X Y b Z t]"), {travel, travel, travel});
  for (int motion = 0; motion < machine::kMotions; ++motion) {
    model.SetForm(0, motion, machine::MakePolynomialForm(2, travel.first, travel.last));
    model.SetCoefficients(0, motion, Eigen::Vector3d(0.0, 1e-5, 2e-5));
  }
  model.SetSquareness({1e-5, 2e-5, -1e-5});
  return {{}, std::move(model), {}};
}

}  // namespace abbe::fuzz
