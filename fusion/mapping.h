// Local parameter sets of the linkage over a grid of calibration poses.
//
//   const MappedParameters cells = MapParameters(simulation, run, x);
//   const Eigen::Matrix3Xd p_MT = BlendedTips(model, X_MB, x_model, cells, readings);
//
// Background: an incomplete model fits a small volume better than a large one. The poses are on a
// grid of the machine's axes. Every inner grid point is the centre of a cell: it and the 12 points
// around it at (+-1, +-1, 0), (+-1, 0, +-1), (0, +-1, +-1) steps, the corners of a cuboctahedron of
// volume (20/3) hx hy hz. A cell has parameters of its own, estimated from its
// 13 poses with the base held at its global estimate. The priors have the width of the
// manufacturing tolerance around the global values, so parameters that the poses do not determine
// stay global; so does a cell without poses.
// Between centres the corrected position is the trilinear blend of the cells at the corners, beyond
// the outer centres that of the nearest ones: continuous everywhere.
//
// Frames: M, B, T as in LinkageSimulation; the grid runs along the axes of M.
// Units: m, rad. Shapes: one parameter set a centre, z fastest, then y, then x.
// Failure: InputError with the number of levels when the positions form no grid of at least 3 x 3 x
// 3 points; NumericalError when a cell does not converge.
// Source: Boelens, "Error Parameter Model that made three dimensional tool path measurement in the
// micron domain possible" (2006), section "Mapping of the parameters"; the spacing of its grid is
// not stated, 7 x 7 x 12 over 25 x 25 x 50 mm gives its 530 mm^3. When not to use: a complete model
// is better global (docs/calibrate.md).
// Validity: inside the grid; a cell of 13 poses determines few of its parameters, the others stay
// global.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fusion/calibration.h"
#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {

inline constexpr double kSameLevel = 50e-6;  // m: positions closer than this are one level

// `x`: the global parameters of the simulation for the mounting of the run.
MappedParameters MapParameters(const simulation::LinkageSimulation& simulation,
                               const simulation::LinkageRun& run, const Eigen::VectorXd& x);

// The ball position by the parameters of each cell minus that by the global ones, in M, at the pose
// nearest to the centre of the cell. `x` as above.
Eigen::Matrix3Xd CellShifts(const simulation::LinkageSimulation& simulation,
                            const simulation::LinkageRun& run, const Eigen::VectorXd& x,
                            const MappedParameters& mapped);

// p_MT of each pose; `values` are the global parameters of the model.
Eigen::Matrix3Xd BlendedTips(const relm::LinkageModel& model,
                             const geometry::Transform<double>& X_MB, const Eigen::VectorXd& values,
                             const MappedParameters& mapped, const relm::LinkageReadings& readings);

}  // namespace abbe::fusion
