// The parts of the rig's linkage that hidden effects change: as drawn, then with the effects.
// Units: m, rad, 1/K. Failure: none.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "rig/hidden_effect.h"

namespace abbe::rig {

inline constexpr int kPivots = 3;

struct Harmonic {
  int order;
  double sine, cosine;

  double At(double angle) const;
};

struct PivotTruth {
  Eigen::Vector3d point, direction;              // of its axis in B at zero angles; unit
  std::array<Eigen::Vector3d, 2> across;         // two directions across the axis, at zero angles
  std::array<std::vector<Harmonic>, 2> run_out;  // m, along `across`
  double encoder_zero;                           // rad
  std::vector<Harmonic> encoder;                 // rad; order 1 is the eccentricity
  std::vector<Harmonic> stretch;                 // m, longer link after it: hidden roundness
  double give;                                   // rad, deflection under a horizontal link
};

struct LinkageParts {
  std::array<PivotTruth, kPivots> pivots;
  std::array<double, 2> expansion;  // of the links
};

}  // namespace abbe::rig
