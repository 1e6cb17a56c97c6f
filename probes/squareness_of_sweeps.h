// The squareness of two axes from the sweeps of both with one mounting of the target.
//
// The slope of a measured straightness is the slope of the motion plus the tilt of the target's
// face. In the sum of two sweeps with one mounting the tilt cancels; the squareness t of the
// target's own faces remains, and its certificate must state it:
//
//   C0Y = -slope(EYX) - slope(EXY) + t     B0Z = slope(EZX) + slope(EXZ) + t
//   A0Z = -slope(EZY) - slope(EYZ) + t     t: target.squareness_urad
//
// Lines: least squares over the stations, at the axis reference. Signs: standards/squareness.h.
// Units: rad.
// Validity: t and the two slopes are taken as independent. Their common sources (gains,
// installation) enter a slope as a product with a tilt, 0.3 urad for 500 ppm and 500 urad: small
// against the uncertainty of t.
//
// Frames: M; slopes at the axis reference. Shapes: one number.
// Failure: InputError that says which condition fails and what to do: two sweeps of different axes
// and of one machine; the same `mounting` in both headers; target.u_squareness_urad above zero.
// Source: own; the sign of t is that of the side face of docs/sweep.md.
#pragma once

#include <string>

#include "probes/sweep_result.h"

namespace abbe::probes {

struct SquarenessResult {
  std::string name;  // "C0Y", "B0Z", "A0Z"
  double value;      // rad
  double u;          // rad, standard
  double u_slopes;   // rad, contribution of the sweeps to u
  double u_target;   // rad, contribution of the target to u
};

// The two sweeps may be given in either order.
SquarenessResult SquarenessOfSweeps(const SweepResult& one, const SweepResult& other,
                                    const TargetSettings& target);

}  // namespace abbe::probes
