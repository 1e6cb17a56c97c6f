// Squareness from the diagonals of a hole plate, to compare with that of the fit.
//
//   SquarenessByDiagonals(fused, reference, setups)
//
// On a machine whose axes are not square, one diagonal of a plate in their plane is measured too
// long, the other too short. With the other errors of the machine and the form of the plate
// corrected:
//
//   stretch = length in the plate / length on the machine - 1 = scale + sign squareness d_i d_j
//   squareness = sign (stretch_1 - stretch_2) / ((d_i d_j)_1 - (d_i d_j)_2)
//
// d the direction of a diagonal, i and j the axes; sign is + for B0Z, - for A0Z and C0Y. Set-ups in
// one plane are averaged; a plate that lies askew (beyond 8 degrees) is left out.
//
// The corrections were fitted to the same readings. To first order the value is that of the fit
// plus b' r: r are the whitened residuals of the fit, b the derivatives of the value with respect
// to them, not zero for the holes at the ends of the diagonals. The errors of a fit are
// uncorrelated with its residuals, which have the covariance I - J C J', so that
//
//   u^2 = u_fit^2 + b' b - (J' b)' C (J' b)
//
// with u_fit that of the map and the noise of each set-up as the fit found it.
//
// Frames: d in the machine's axes.
// Units: rad. Shapes: three squarenesses, A0Z, B0Z, C0Y.
// Failure: none; without a plate in a plane `setups` is 0 and the value NaN.
// Source: Ha and Khanh, "An application of neural network in calibration of coordinate measuring
// machines" (2011), section 3: squareness by the diagonal method and the errors calculated before;
// the uncertainty is ours.
// Validity: first order. The fit uses every hole and is never worse.
#pragma once

#include <array>
#include <vector>

#include "fusion/fuse.h"
#include "simulation/points/plate_simulation.h"

namespace abbe::fusion {

struct DiagonalSquareness {
  double value, u;
  int setups;
};

// A0Z, B0Z, C0Y. `fused`: of the set-ups, in their order, and of no other runs before them.
std::array<DiagonalSquareness, 3> SquarenessByDiagonals(
    const FuseReport& fused, const Eigen::Vector3d& reference,
    const std::vector<simulation::PlateSetup>& setups);

}  // namespace abbe::fusion
