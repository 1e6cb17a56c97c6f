// What the geometry of an arm alone makes of one of its runs.
//
//   const ArmBaseline baseline = FitArm(run, settings);
//   const std::vector<Eigen::Index> far = FarOff(run, baseline);     // no readings of this arm
//
// Outliers: the arm with the tolerances of its machine file, but joints that may err up to three
// times per turn by kLenient, and by that a metre under weights, lest a cause make outliers, is
// fitted; a pose whose gap is more than kFar times the usual one (from the median, as if normal) is
// left out, and the rest fitted and looked at once more: further looks would take out what the
// model lacks. Where more than a tenth would go they are no outliers: all stay. The rest is fitted
// with the tolerances as they are. What the fit leaves beyond the stated noise is excess noise
// (excess_noise.h).
// Frames: those of arm_run.h.
// Units: m, rad; gaps whitened with the stated noise. Shapes: gaps 3 x poses.
// Failure: InputError where angles and places do not go together; that of SolveLinkage.
// Source: own.
// Validity: fewer than a tenth of the poses are no readings of the arm, and the geometry is within
// its tolerances.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "relm/linkage_settings.h"
#include "simulation/linkage/linkage_run.h"

namespace abbe::simulation {

inline constexpr double kLenient = 2e-3;  // rad, rad/m

struct ArmBaseline {
  std::string mounting;            // of its base
  std::string ball;                // LinkageRun::ball
  relm::LinkageSettings settings;  // its base where the instrument saw it
  Eigen::VectorXd x;               // of ArmSimulation(settings): what fits most poses
  relm::LinkageSettings lenient;   // with joints that may err more
  Eigen::VectorXd lenient_x;       // likewise
  double far = 0.0;                // whitened gap against `lenient` from which on a pose is none
  double excess = 1.0;             // of what the run leaves over its stated noise, at least 1
};

// `placed`: simulation/arm/arm_run.h, or as another run with the same base has it.
ArmBaseline FitArm(const LinkageRun& run, const relm::LinkageSettings& placed);

// Indices into `run`; empty: none.
std::vector<Eigen::Index> FarOff(const LinkageRun& run, const ArmBaseline& baseline);

// m, at the baseline.
Eigen::Matrix3Xd GapsOf(const LinkageRun& run, const ArmBaseline& baseline);

}  // namespace abbe::simulation
