// Waves of a positioning error that are shorter than the places of a run are apart: are they there,
// along which axis, and what of them can a map not hold?
//
//   const PlaceScatter found = FindPlaceScatter(run, left, model, prior);
//   const double um = 1e6 * found.sd;  // along X, Y or Z by found.axis, where that is not -1
//
// Such a wave (screw, gear, scale) looks like noise, but noise of the instrument goes in the
// directions of its encoders, and the wave in that of one axis. With r the whitened rows of a pose
// and G = U D V' what they show of a metre along an axis, or of a radian of encoders, the
// hypotheses are
//
//   cov r = c^2 (I + rho^2 G G')      log L(rho) = -n log c - sum log(1 + rho^2 D^2) / 2
//   c^2 = sum (r'r - (U'r)^2 rho^2 D^2 / (1 + rho^2 D^2)) / n
//
// with n rows together; rho = 0 is noise alone. An axis is named where it gains ten over noise
// alone (22 000 : 1) and more than its rivals: each encoder, all encoders, all axes together. Poses
// far off all others (25 times the median square) are left out: an outlier is no wave. What the map
// holds of waves (machine_prior.h) is added to r first where these are evident: at places on the
// planes of a grid smooth errors may be taken for waves.
//
// Places in clusters show only what changes within a cluster. So the size of what the map does not
// hold is that of another process beside those of the map: the error that was measured at the
// positions x, e = E(x) + g'r / g'g, E that of the fit and g the G of the axis, has
//
//   cov e = c^2 diag(1 / g'g) + s^2 I + S V S' + t^2 exp(-(dx / l)^2 / 2)
//
// S the splines of the error at x, V their prior, s what scatters without a place (rounding, play).
// `sd` is the root of the mean of s^2 + t^2 under their posterior: log l uniform from 0.5 mm to a
// fifth of the correlation length of the error, log t normal about 1 um with standard deviation
// log 4 (own choice), s one of four parts of rho c.
// Units: m. Shapes: `left`: the rows of the run's residual at the fit, over the stated noise.
// Failure: none; a run without a response, or with one row for each place, cannot tell.
// Source: own; Rasmussen and Williams (2006), 5.4.1 for the posterior.
// Validity: all other parameters as the fit has them; at most 250 places, evenly chosen, for sd.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "fusion/machine_prior.h"
#include "fusion/seen_errors.h"
#include "machine/volumetric_model.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

struct PlaceScatter {
  int axis = -1;      // 0 to 2; -1: none
  double sd = 0.0;    // m, anywhere on the axis, of what the map does not hold
  double held = 0.0;  // m, the same of the waves that the map holds
  double size() const { return std::hypot(sd, held); }
};

// The axes of which a run has places at twenty positions or more, 0.1 mm apart: such places tell a
// wave from a smooth error; on the few planes of a grid the two are alike.
std::array<bool, machine::kAxes> ThatMayShowWaves(
    const std::vector<simulation::SimulatedRun>& runs);

// `found`: the model of the fit; `prior`: of its functions; `evident`: the axes whose waves in the
// model are sure to be there (PopulationEvidence::EvidentWaves).
PlaceScatter FindPlaceScatter(const simulation::SimulatedRun& run, const Eigen::VectorXd& left,
                              const machine::VolumetricModel& found, const MachinePrior& prior,
                              const std::array<bool, machine::kAxes>& evident = {});

// Widens the positioning errors of `found` by the largest scatter of each axis.
void CountScatter(const std::vector<PlaceScatter>& scatter, const machine::VolumetricModel& found,
                  SeenErrors& seen);

}  // namespace abbe::fusion
