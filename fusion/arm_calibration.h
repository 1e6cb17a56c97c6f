// The calibration of an arm before an instrument that stands anywhere: the numbers of its
// Denavit-Hartenberg rows or axes, with U95, and what they do for poses that took no part.
//
//   const ArmCalibration found = CalibrateArm(settings, runs, tests);
//   relm::WithGeometry(text, found.written, found.u95, "arm.toml");
//   found.tests[0].before.rms, found.tests[0].after.rms;             // m
//
// Fitted are the lines of all joints, their encoder offsets, the balls, and where the instrument
// stands (simulation/arm/arm_run.h); errors that are no geometry (eccentricity, gears, weights) are
// not, and count as noise: what the geometry leaves beyond the stated noise does
// (simulation/excess_noise.h). Where what is left is no noise but goes with the posture or with time,
// such as by weight, U95 contains what the geometry may have taken of it (fusion/arm_discrepancy.h).
// Poses far off all others are left out, as in a diagnosis. "Before"
// is the arm as the file has it, with the place of the instrument and of further balls found from
// `runs` alone, "after" the written numbers alone. `with`: corrected for causes
// (simulation/correction.h); before is then of the recordings as they are.
// Frames: those of relm/chain_rows.h; the instrument's stands anywhere.
// Units: m, rad. Shapes: `u95` as written.Numbers().
// Failure: InputError for no run, too few poses for the free parameters, a test of a base or a ball
// of which no run is, estimates that contradict their tolerances; that of relm/chain_rows.h.
// NumericalError when the fit does not converge.
// Source: product of exponentials (relm/serial_chain.h), least squares (estimation/problem.h).
// Validity: geometry only; an arm that bends under its load by more than the noise shows as
// `excess` and `no_noise`.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "fusion/calibrate.h"
#include "relm/chain_rows.h"
#include "relm/linkage_settings.h"
#include "simulation/linkage/linkage_run.h"

namespace abbe::fusion {

// A recording of an arm as it is, and without causes (the same where none is taken out).
struct ArmPoses {
  simulation::LinkageRun recorded, corrected;
};

struct ArmFigures {
  std::string name;
  Eigen::Index poses = 0, left_out = 0;
  Distances before, after;
};

struct ArmCalibration {
  relm::WrittenChain nominal, written;
  Eigen::VectorXd u95;  // of written.Numbers(); 0: held
  // Further balls in the frame of the last row (of axes in W), m.
  std::vector<std::pair<std::string, Eigen::Vector3d>> balls;
  std::vector<ArmFigures> runs, tests;
  double excess = 1.0;      // residuals over stated noise, the largest of a run; U95 contains it
  double no_noise = 0.0;    // probability that what is left goes with the posture or with time
  double ball_noise = 0.0;  // m rms a coordinate: what the uncertainties of all numbers make
};

// Fits `runs`; `tests` take no part in the fit.
ArmCalibration CalibrateArm(const relm::LinkageSettings& settings,
                            const std::vector<ArmPoses>& runs, const std::vector<ArmPoses>& tests);

// Causes that are not certain, or beside which something is unexplained, m rms (simulation/doubt.h):
// U95 contains the change against the calibration `without` them and that, as far as it is left of
// the ball in the runs.
void AddDoubt(const ArmCalibration& without, double unexplained, ArmCalibration& found);

}  // namespace abbe::fusion
