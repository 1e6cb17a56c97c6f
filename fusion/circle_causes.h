// The causes of a circle's deviations: all causes of the signature table in one joint fit.
//
//   const CircleCauses causes = FitCircleCauses({&slow, &fast}, {});
//   for (const CauseEstimate& one : causes.causes) {
//     fmt::print("{}: {} +- {}\n", one.cause, one.value, one.u);
//   }
//
// The runs are of one instrument, plane and radius, in both senses and at two feeds where that was
// measured. The fit is joint because causes share harmonics (standards/circle_signatures.h). Its
// nuisance parameters are
//   - the centre of each run, which is that of the set-up,
//   - harmonics from order 4 on with the standard deviations `smooth`. The smooth errors of the
//     machine, equal in both senses, have harmonics of every order; no cause explains these, and
//     without them they would pass for reversal spikes and through these for backlash,
//   - the errors of the instrument: `shifted` holds the runs with one independent error of it
//     changed by one standard deviation.
// Backlash is taken up at once, with play, or by wind-up on ways from 0.5 um to 8 mm; near the best of
// these the way of each axis is one more unknown, known to a factor of e. Spikes rise or are there at
// once, as wide at all feeds or in proportion to them, the width of each axis one more unknown, and
// of a form known to a quarter of their height (reversal_shapes.h). Results are the mean of the fits
// by their likelihood, less what that form costs by its prior, and their spread is in u (Bayesian
// model averaging: Hoeting et al., Statistical Science 14 (1999)).
// Units: SI; `effect` is the largest radial deviation of a cause in m, without sign.
// Noise: estimated from the residuals and their degrees of freedom, whose Student's t is in u (2 u is
// a U95). What it remembers along the path is estimated for each run (row_memory.h); what is left of
// that enlarges it by the factor by which the means of 10 degrees scatter more than those of
// independent rows. Deviations that no cause explains therefore enlarge the uncertainties. `seen` is
// false where the prior (the `usual` amount of a machine tool) determines the value more than the
// data: one sense cannot separate squareness from servo mismatch, nor one feed scale from lag.
// So that enough degrees of freedom are left, sparse points have fewer harmonics.
// Failure: InputError for no run, runs of different circles, or fewer points than parameters;
// NumericalError from the fit.
// Source: linear least squares (estimation/problem.h). Validity: errors small against the radius;
// an error of the instrument that is not in `shifted` is attributed to the machine.
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
  // wide priors for orders 4 to 12.
  std::vector<double> smooth = std::vector<double>(9, 20e-6);
  std::vector<std::vector<const paths::CircleRun*>> shifted = {};  // [error][run]
};

struct CauseEstimate {
  std::string cause, object, unit;
  double value = 0.0;
  double u = 0.0;
  double effect = 0.0;
  bool seen = false;
  std::string alike = {};  // "-EYY": what has the same signature (standards/circle_signatures.h)
};

struct CircleCauses {
  std::vector<CauseEstimate> causes;  // without the centres
  std::vector<std::string> weak_directions;
  double rms_before = 0.0;  // m: of the radius about centre and mean radius of each run
  double rms_smooth = 0.0;  // m: of the fitted smooth errors and errors of the instrument
  double rms_after = 0.0;   // m: of the residuals
  double correlated = 1.0;  // the factor on the standard deviation of what is not remembered
  // The residuals over their scatter from point to point: near 1 for noise, larger for what no cause
  // of the table does.
  double beyond_noise = 1.0;
  double freedom = 0.0;        // degrees of freedom of the noise, of independent rows
  Eigen::MatrixXd covariance;  // of `causes`, in their order
  std::vector<std::vector<double>> residuals;  // m, [run][point]: without the causes

  // Whether the residuals are noise.
  bool TableHolds() const;
  // Determined by the data, beyond its U95 and, where the table does not hold, larger on the radius
  // than what it may stand in for: kStandsOut times the residuals.
  bool IsCertain(const CauseEstimate& one) const;
  static constexpr double kStandsOut = 5.0;
};

CircleCauses FitCircleCauses(const std::vector<const paths::CircleRun*>& runs,
                             CauseOptions options = {});

}  // namespace abbe::fusion
