// An error map as Python holds it, with what evaluates it fast.
#pragma once

#include <utility>

#include "arrays.h"
#include "machine/volumetric_field.h"
#include "map/error_map.h"

namespace abbe::python {

struct Map {
  explicit Map(map::ErrorMap of) : map(std::move(of)), field(map.model()) {}

  // None: that of the measurement.
  Eigen::Vector3d Tool(const std::optional<Array>& tool) const {
    if (!tool) return map.origin().tool;
    return Numbers(*tool, 3, "tool_m");
  }

  map::ErrorMap map;
  machine::VolumetricField field;
};

}  // namespace abbe::python
