// What a run of a hole plate should read: where the tool point is when a hole centre is found.
//
//   for (const PlateSetup& setup : ReadPlate(recording)) {
//     runs.push_back(SimulatePlate(model, reference, setup));
//   }
//
// One plate lies in the volume in several set-ups. In each, the probe seeks the centre of every
// hole in the plate's plane, its depth is not measured, and the axes are read:
//
//   residual = ( [u v] of X_MP^-1 p_MQ(axes) - (1 + scale) (certificate + form) ) / u_probing
//
// with p_MQ of simulation/points/machine_points.h; u_probing_um stands in the header. The tool
// point of set-up N is `tool_mm` of the header's table [setup.N], or `tool_mm` for all.
// Frames: M, the machine frame as the workpiece carries it; P, the plate: u along plate_x, v along
// plate_y. X_MP starts where the plate fits the axes best on a perfect machine. Unknowns, in this
// order: the machine's functions and squareness; of the set-up "plate_place RUN" [u v] and
// "plate_turn RUN" about w, of which nothing is known; "plate_scale PLATE", where the header states
// u_scale_ppm; and where the column u_plate_um is there, "plate_hole PLATE N" [u v], the form: the
// plate is the header's `plate`, and what is said of its hole N holds in all its set-ups.
// Units: m, rad. Shapes: two rows a hole, u and v.
// Failure: InputError with recording and row: no u_probing_um, a set-up without tool or of less
// than three holes that span a plane, a hole in two places of the certificate, a hole that is not
// where the plate says; that of simulation/points/machine_points.h. No loss: a robust one follows a
// plate that slipped while it was measured for a hundred passes; without one its set-up is named at
// once (fusion/run_consistency.h).
// Source: Ha and Khanh, "An application of neural network in calibration of coordinate measuring
// machines" (2011), section 3.
// Validity: the other three numbers of the pose stay at the start, to 1 mrad: 0.5 ppm of a length
// in the plate.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/transform.h"
#include "machine/volumetric_model.h"
#include "recording/recording.h"
#include "simulation/points/machine_points.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

struct PlateSetup {
  MachinePoints points;  // `name` is that of the recording with the number of the set-up
  std::string plate;
  std::vector<int> holes;        // of each point: its number
  Eigen::Matrix2Xd certificate;  // of each point: [u v]
  Eigen::VectorXd u_form;        // of each point; 0: the certificate is right
  double u_scale = 0.0;          // relative; 0: right
  double u_probing = 0.0;        // of each direction
};

// In the order of first appearance.
std::vector<PlateSetup> ReadPlate(const recording::Recording& recording);

// These points of a set-up alone.
PlateSetup PartOf(const PlateSetup& all, const std::vector<Eigen::Index>& of);

// The block of the form of a hole.
std::string HoleBlock(const PlateSetup& setup, int hole);

// X_MP: where the plate lies on a machine without errors.
geometry::Transform<double> PlatePose(const PointsOnMachine& points, const PlateSetup& setup);

// Rows u, v of the first point, then of the second, ... `reference`: the machine's, m, in M.
SimulatedRun SimulatePlate(const machine::VolumetricModel& model, const Eigen::Vector3d& reference,
                           const PlateSetup& setup);

}  // namespace abbe::simulation
