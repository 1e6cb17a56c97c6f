// The squareness of two axes from the sweeps of both, if both looked at the same mounted target.
//
// The slope of a measured straightness is the slope of the motion plus the tilt of the target's
// face. In the sum of two sweeps the tilt of a target that was not mounted anew cancels; what stays
// is the squareness of its own faces, which its certificate must state:
//
//   C0Y = -slope(EYX) - slope(EXY) + t     B0Z = slope(EZX) + slope(EXZ) + t
//   A0Z = -slope(EZY) - slope(EYZ) + t     t: target.squareness_urad
//
// Lines: least squares over the stations, at the axis reference. Sense: standards/squareness.h.
// Units: rad. Validity: t and the two slopes count as independent; what they share (gains,
// installation) enters each slope times a tilt, 0.3 urad for 500 ppm and 500 urad, so it is small
// against t's uncertainty.
//
// Failure: InputError that says which condition fails and what to do: two sweeps of different axes
// and of one machine; the same `mounting` in both headers; target.u_squareness_urad above zero.
#pragma once

#include <string>

#include "probes/sweep_result.h"

namespace abbe::probes {

struct SquarenessResult {
  std::string name;  // "C0Y", "B0Z", "A0Z"
  double value;      // rad
  double u;          // rad, standard
  double u_slopes;   // rad, what of it comes from the sweeps
  double u_target;   // rad, what of it comes from the target
};

// The order of the sweeps is free.
SquarenessResult SquarenessOfSweeps(const SweepResult& one, const SweepResult& other,
                                    const TargetSettings& target);

}  // namespace abbe::probes
