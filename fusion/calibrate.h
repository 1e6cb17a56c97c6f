// The calibration of the linkage: its parameters from runs, with uncertainty, observability and
// held-out residuals.
//
//   const CalibrationReport report = Calibrate(chain, linkage, runs, {});
//   WriteCalibration(report.calibration, "linkage.toml");
//   report.held_out.rms;               // m: of held-out ball positions
//
// Cross-validation: the poses of each run are split into `folds` blocks in order of time, and each
// block in turn is predicted by a calibration from all others. Blocks, because neighbouring poses
// share errors and single held-out poses would be predicted too well.
// Noise: where the residuals of a run are larger than [linkage.noise] states, or go on from pose to
// pose (a reference that drifts; row_memory.h), the fit counts them as they are: `noise`. A table that
// knows no time shows no memory.
// Frames: M; B the base, T the ball (LinkageSimulation).
// Units: m, rad. Shapes: as in LinkageSimulation.
// Failure: InputError for too few poses, poses on one line or all in one place, for encoders that
// are swapped, reversed or of wrong counts (fusion/encoder_check.h), and for estimates that
// contradict their priors: each says which and what to do. NumericalError when a fit does not
// converge.
// Source: docs/theory-linkage.md for the models; cross-validation by blocks, Burman, Chow and Nolan
// (1994).
// Validity: machine errors that the reference does not measure bias the parameters of the linkage.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/result.h"
#include "fusion/calibration.h"
#include "fusion/observability.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {

struct CalibrateOptions {
  relm::ErrorModel model = relm::ErrorModel::kComplete;
  simulation::LinkageProblemOptions problem = {};
  int folds = 5;        // below 2: nothing is held out
  bool mapped = false;  // also local parameter sets, fusion/mapping.h
  // Accept estimates that contradict their priors: an incomplete model moves its parameters beyond
  // their tolerances, and its residuals are still of interest.
  bool contradict = false;
};

// Distances between measured and true ball positions, 3D.
struct Distances {
  double rms = 0.0;
  double max = 0.0;
};
// The lengths of the columns, m.
Distances DistancesOf(const Eigen::Matrix3Xd& gaps);

struct PoseResidual {
  std::size_t run;
  Eigen::Index pose;
  std::size_t row;           // of the recording, from 0
  Eigen::Vector3d before;    // m, in M: nominal linkage, its base registered
  Eigen::Vector3d gap;       // m, in M
  Eigen::Vector3d held_out;  // m: when the pose is held out; NaN without folds
  double normalised;         // largest of the three whitened rows
};

struct CalibrationReport {
  Calibration calibration;
  estimation::Result fit;
  Observability seen;
  Distances before;                         // nominal linkage, its base registered
  Distances after;                          // of all poses
  Distances held_out;                       // NaN without folds
  std::vector<PoseResidual> residuals;      // in the order of runs and poses
  std::vector<PoseResidual> outliers;       // beyond estimation::kOutlierAt, worst first
  Eigen::Matrix3Xd cell_shifts;             // m, with `mapped`: CellShifts, fusion/mapping.h
  double excess = 1.0;                      // residuals over stated noise, at least 1
  std::vector<simulation::RunNoise> noise;  // of each run, as the fit counts it
};

// All runs together; a base for each mounting.
CalibrationReport Calibrate(const machine::Chain& chain, const relm::LinkageSettings& settings,
                            const std::vector<simulation::LinkageRun>& runs,
                            const CalibrateOptions& options);

}  // namespace abbe::fusion
