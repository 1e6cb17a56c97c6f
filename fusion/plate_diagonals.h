// Squareness from the diagonals of a hole plate, beside that of the fit.
//
//   SquarenessByDiagonals(model, reference, setups, fit)
//
// A plate that lies in two axes has a shorter and a longer diagonal on a machine whose axes are not
// square. With all other errors of the machine taken off, and the form of the plate known:
//
//   stretch = length in the plate / length on the machine - 1 = scale + sign squareness d_i d_j
//   squareness = sign (stretch_1 - stretch_2) / ((d_i d_j)_1 - (d_i d_j)_2)
//
// d the direction of a diagonal, i and j the axes; sign is + for B0Z, - for A0Z and C0Y. Set-ups in
// one plane are averaged; a plate that lies askew (beyond 8 degrees) is left out.
//
// What is taken off was fitted to the same readings. To first order the value is that of the fit
// plus b' r: r the whitened residuals that the fit leaves, b as above, not zero for the holes at
// the ends of the diagonals. The errors of a fit are uncorrelated with what it leaves, which has
// the covariance I - J C J', so that
//
//   u^2 = u_fit^2 + b' b - (J' b)' C (J' b)
//
// Units: rad. Failure: none; without a plate in a plane `setups` is 0 and the value NaN.
// Source: Ha and Khanh, "An application of neural network in calibration of coordinate measuring
// machines" (2011), section 3: squareness by the diagonal method and the errors calculated before;
// the uncertainty is ours. Validity: first order. The fit uses every hole and is never worse.
#pragma once

#include <array>
#include <vector>

#include "estimation/result.h"
#include "simulation/points/plate_simulation.h"

namespace abbe::fusion {

struct DiagonalSquareness {
  double value, u;
  int setups;
};

// Of A0Z, B0Z, C0Y. `model` as fitted, `fit` with the form of the plate.
std::array<DiagonalSquareness, 3> SquarenessByDiagonals(
    const machine::VolumetricModel& model, const Eigen::Vector3d& reference,
    const std::vector<simulation::PlateSetup>& setups, const estimation::Result& fit);

}  // namespace abbe::fusion
