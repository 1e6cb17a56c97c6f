// What the geometry of an arm alone makes of one of its runs.
//
//   const ArmBaseline baseline = FitArm(run, settings);
//   const std::vector<Eigen::Index> far = FarOff(run, baseline);     // no readings of this arm
//
// Poses that are none: the arm with the tolerances of its machine file, but joints that may err up
// to three times per turn and under gravity by kLenient, lest a cause make outliers, is fitted; a
// pose whose gap is more than kFar times the usual one (from the median, as if normal) is left out,
// and the rest fitted again. Where more than a tenth would go they are no outliers: all stay.
// The rest is fitted with the tolerances as they are.
// What the fit leaves beyond the stated noise is noise until a cause explains it: no model of an
// arm is as exact as a tracker, and against the noise of the tracker every cause would be certain.
// Poses that follow each other share it, so its variance counts as often as they do:
//
//   excess^2 = chi-square / redundancy * (1 + 2 sum of rho_k),   rho_k: correlation k poses apart,
//
// the sum up to the first that white noise could have. Up to kNoiseIsKnown the stated noise stands.
// Source: Sokal, Monte Carlo methods (1996), 2 (integrated autocorrelation).
// Units: m, rad; gaps whitened with the stated noise. Failure: InputError where angles and places
// do not go together; that of fusion::SolveLinkage.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/fit.h"
#include "estimation/result.h"
#include "simulation/linkage/linkage_run.h"

namespace abbe::diagnosis {

inline constexpr double kLenient = 2e-3;  // rad

// `placed`: simulation/arm/arm_run.h, or as another run with the same base has it.
ArmBaseline FitArm(const simulation::LinkageRun& run, const relm::LinkageSettings& placed);

std::vector<Eigen::Index> FarOff(const simulation::LinkageRun& run, const ArmBaseline& baseline);

// m, at the baseline.
Eigen::Matrix3Xd GapsOf(const simulation::LinkageRun& run, const ArmBaseline& baseline);

// Of a fit that believed `used`; `left`: its rows in the order of the poses, whitened with that.
double ExcessOf(const estimation::SourceResult& run, const Eigen::VectorXd& left, double used);

// Of all runs of a fit; 1 of those whose noise is believed.
std::vector<double> ExcessOf(const Fit& fit);

}  // namespace abbe::diagnosis
