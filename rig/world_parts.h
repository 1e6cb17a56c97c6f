// The parts of the rig's machine and head that hidden effects change: as drawn, then with the
// effects. Units: m, rad. Failure: none.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "rig/axis_errors.h"
#include "rig/hidden_effect.h"
#include "rig/probe_head.h"

namespace abbe::rig {

// The hidden response of the probes, in d = gap at the start - gap.
struct HiddenResponse {
  Readings quadratic{};                                   // 1/m
  std::array<std::array<double, kProbes>, kProbes> of{};  // of[i][k]: of d of k in the reading i
  std::array<bool, kProbes> inverted{};
  bool any = false;
};

struct WorldParts {
  Squareness squareness;
  std::array<ProbeTruth, kProbes> probes;
  double electrode;  // radius; 0: points
  HiddenResponse response = {};
  Eigen::Vector3d head_angles = Eigen::Vector3d::Zero();   // of the installation
  Eigen::Vector3d head_offsets = Eigen::Vector3d::Zero();  // likewise
  std::array<std::vector<double>, 2> forms = {};           // rms of the faces: top, side
};

}  // namespace abbe::rig
