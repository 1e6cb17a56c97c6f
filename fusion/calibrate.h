// The calibration of the linkage: from runs to parameters, with what they can be believed.
//
//   const CalibrationReport report = Calibrate(chain, linkage, runs, {});
//   WriteCalibration(report.calibration, "linkage.toml");
//   report.held_out.rms;               // m: of ball positions that took no part
//
// The poses of each run are split into `folds` blocks in order of time; each block in turn is
// predicted by a calibration from all others. Neighbours share their errors, so single poses held
// out would look too good.
// Units: m, rad. Shapes: as in LinkageSimulation.
// Failure: InputError for too few poses, poses on one line or all in one place, for encoders that
// are swapped, reversed or of wrong counts (fusion/encoder_check.h), and for estimates that
// contradict their priors: each says which and what to do. NumericalError when a fit does not
// converge. Validity: errors of the machine that the reference does not know go into the parameters
// of the linkage.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/result.h"
#include "fusion/calibration.h"
#include "fusion/linkage_problem.h"
#include "fusion/observability.h"

namespace abbe::fusion {

struct CalibrateOptions {
  relm::ErrorModel model = relm::ErrorModel::kComplete;
  LinkageProblemOptions problem = {};
  int folds = 5;        // below 2: nothing is held out
  bool mapped = false;  // also local parameter sets, fusion/mapping.h
  // Whether estimates may contradict their priors: a model that leaves something out bends its
  // parameters beyond their tolerances, and still says how well it does.
  bool contradict = false;
};

// Of distances between measured and true ball positions, 3D.
struct Distances {
  double rms = 0.0;
  double max = 0.0;
};
Distances DistancesOf(const Eigen::Matrix3Xd& gaps);

struct PoseResidual {
  std::size_t run;
  Eigen::Index pose;
  std::size_t row;           // of the recording, from 0
  Eigen::Vector3d before;    // m, in M: nominal linkage, its base registered
  Eigen::Vector3d gap;       // m, in M
  Eigen::Vector3d held_out;  // m: when the pose took no part; NaN without folds
  double normalised;         // largest of the three whitened rows
};

struct CalibrationReport {
  Calibration calibration;
  estimation::Result fit;
  Observability seen;
  Distances before;                     // nominal linkage, its base registered
  Distances after;                      // of all poses
  Distances held_out;                   // NaN without folds
  std::vector<PoseResidual> residuals;  // in the order of runs and poses
  std::vector<PoseResidual> outliers;   // beyond estimation::kOutlierAt, worst first
  Eigen::Matrix3Xd cell_shifts;         // m, of the cells of a mapped one: fusion/mapping.h
  // Residuals over the noise that was stated; beyond 1 the uncertainties are too small by it.
  double excess = 1.0;
};

CalibrationReport Calibrate(const machine::Chain& chain, const relm::LinkageSettings& settings,
                            const std::vector<simulation::LinkageRun>& runs,
                            const CalibrateOptions& options);

}  // namespace abbe::fusion
