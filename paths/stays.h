// The stays of a path: mean positions during standstills.
//
// A stay is a sequence of rows whose commanded position keeps within `window` of its first row, at
// least `kLeastRows` rows long. Its first quarter, in which the machine settles, is left out.
// Units: m. Failure: none. Validity: stays of equal commanded position are separate entries.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "paths/measured_path.h"

namespace abbe::paths {

struct Stay {
  Eigen::Vector3d commanded, measured;  // means
  Eigen::Vector3d scatter;              // standard deviation of one row of `measured`
  std::size_t rows;                     // averaged
};

inline constexpr Eigen::Index kLeastRows = 5;
inline constexpr double kStayWindow = 5e-6;  // m

std::vector<Stay> Stays(const MeasuredPath& path, double window = kStayWindow);

}  // namespace abbe::paths
