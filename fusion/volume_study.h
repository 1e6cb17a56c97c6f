// Compares calibration volumes and spacings of the poses by the model alone, before any
// measurement.
//
//   for (const VolumeRow& row : StudyVolumes(simulation, travel)) ...
//
// For each grid: how many combinations of parameters it sees, and the standard uncertainty of ball
// positions from the calibration, inside the grid and over the whole travel.
// Frames: grids along the machine axes, centred in `travel`. Units: m. Shapes: sizes 3 x 1.
// Failure: NumericalError when the linkage does not reach a pose. Source: Boelens, "Error Parameter
// Model that made three dimensional tool path measurement in the micron domain possible" (2006),
// recommendation "research optimum calibration volume". Validity: to first order at the nominal
// linkage; noise as in the machine file.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {

struct Travel {
  Eigen::Vector3d first, last;  // m, axis positions
};

// A grid of n points over `size`, centred in the travel, row after row along x.
Eigen::Matrix3Xd GridIn(const Travel& travel, const Eigen::Vector3d& size,
                        const Eigen::Vector3i& n);

struct VolumeRow {
  Eigen::Vector3d size;  // m
  Eigen::Vector3i points;
  Eigen::Index poses = 0;
  Eigen::Index rank = 0;    // combinations seen
  double inside_rms = 0.0;  // m, 3D
  double travel_rms = 0.0;  // m, 3D
};

// Volumes of a quarter of the travel to all of it, at 3 to 9 points along each side.
std::vector<VolumeRow> StudyVolumes(const simulation::LinkageSimulation& simulation,
                                    const Travel& travel);

}  // namespace abbe::fusion
