// What made a circle as it is: all causes of the signature table in one joint fit.
//
//   const CircleCauses causes = FitCircleCauses({&slow, &fast}, {});
//   for (const CauseEstimate& one : causes.causes) {
//     fmt::print("{}: {} +- {}\n", one.cause, one.value, one.u);
//   }
//
// The runs are of one instrument, plane and radius, in both senses and at two feeds where that was
// measured: a reading of the causes one harmonic at a time takes one for another
// (standards/circle_signatures.h). Each run has a centre of its own, which is the set-up's and no
// cause. The smooth errors of the machine, the same in both senses, make harmonics of every order;
// those from order 4 on, which no cause explains, are terms of the fit with the standard deviations
// `smooth`, else they pass for reversal spikes and through these for backlash. So are the errors of
// the instrument: `shifted` holds the runs as they would be if one independent error of it were off
// by one standard deviation.
// Units: SI; `effect` is the largest radial deviation of a cause in m, with its sign left out.
// Noise: the data tell it. The standard deviation of a row is that of the residuals, enlarged by
// what neighbouring rows share: the factor by which the means of 10 degrees scatter more than
// independent rows would let them. So what no cause explains enters the uncertainties.
// `seen` is false where the prior (the `usual` amount of a machine tool) says more than the data:
// one sense cannot tell squareness from servo mismatch, one feed not scale from lag.
// Failure: InputError for no run or runs of different circles; NumericalError from the fit.
// Source: linear least squares (estimation/problem.h). Validity: errors small beside the radius;
// an error of the instrument itself is read as one of the machine.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "fusion/smooth_harmonics.h"
#include "paths/circle_run.h"

namespace abbe::fusion {

struct CauseOptions {
  std::map<char, double> pitch = {};  // m: of cyclic errors, by axis
  double spike_width = 0.07;          // rad
  // m: sine and cosine of order kFirstHarmonic, ... each; fusion/smooth_harmonics.h. By default
  // nothing is known of the machine: orders 4 to 12 are as the data have them.
  std::vector<double> smooth = std::vector<double>(9, 20e-6);
  std::vector<std::vector<const paths::CircleRun*>> shifted = {};  // of each error, all runs
};

struct CauseEstimate {
  std::string cause, object, unit;
  double value = 0.0;
  double u = 0.0;
  double effect = 0.0;
  bool seen = false;
};

struct CircleCauses {
  std::vector<CauseEstimate> causes;  // without the centres
  std::vector<std::string> weak_directions;
  double rms_before = 0.0;     // m: of the radius about centre and mean radius of each run
  double rms_smooth = 0.0;     // m: of smooth errors and errors of the instrument
  double rms_after = 0.0;      // m: without them
  double correlated = 1.0;     // the factor on the standard deviation
  Eigen::MatrixXd covariance;  // of `causes`, in their order
  std::vector<std::vector<double>> residuals;  // m, of each run's points: without the causes
};

CircleCauses FitCircleCauses(const std::vector<const paths::CircleRun*>& runs,
                             const CauseOptions& options = {});

}  // namespace abbe::fusion
