// The mean gap per station, direction of approach and probe from the dwells of a sweep, with the
// covariance of these means.
//
// Generalised least squares. A dwell is its group's mean + the drift of the probe at that time +
// white noise. The drift is the Ornstein-Uhlenbeck process of the machine file, independent for
// each probe; the white variance of a dwell is
//
//   s^2 / n * (1 + r) / (1 - r) - S^2 T / (3 tau)
//
//   s, r    scatter and lag-1 correlation of the readings within the dwells, pooled over all dwells
//   n, T    readings and length of the dwell
//   S, tau  standard deviation and correlation time of the drift, which averaging over T reduces
//
// With one reading per dwell there is no such scatter: the variance is then that of the scatter
// between the passes or, with one pass, that of the machine file.
//
// The scatter between the passes tests this (chi2). Where it is significantly larger, a jump of the
// zero of a probe is looked for (dwell_fit.h); where it is larger still, white noise,
// drift and its time are those that make the dwells most probable (restricted maximum likelihood,
// each within a factor of two of what was said before, normal in its logarithm).
//
// A reading in steps that noise and drift do not average out errs alike in all passes: the variance
// that no repetition shows (estimation/reading_step.h) is added for each station, half of it the
// same in both directions.
//
// Groups are numbered station * directions + k, k in the order of `directions`.
// Frames: none; gaps of the probes.
// Units: m, s. Shapes: gaps 5 x groups, one covariance of groups x groups for each probe.
// Failure: InputError when fewer than three stations were approached from every direction of the
// sweep.
// Source: Aitken's generalised least squares; restricted maximum likelihood of the variances
// (estimation/markov_noise.h).
// Validity: a drift that is one Ornstein-Uhlenbeck process with a time between the dwells and the
// whole sweep; jumps show in chi2.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "probes/head_settings.h"
#include "probes/sweep_dwells.h"

namespace abbe::probes {

struct ProbeFigures {
  double white;  // m, standard deviation of one reading
  double lag1;   // correlation of neighbouring readings
  double drift;  // m, standard deviation of the dwells about their group, white noise subtracted
};

struct NoiseFigures {
  PerProbe<ProbeFigures> probes;
  double chi2 = 0.0;   // of the scatter between passes under the noise model, all probes
  double dof = 0.0;    // its degrees of freedom; 0 with one pass
  double scale = 1.0;  // sqrt(chi2 / dof) where that is significant
  double u_dof = 0.0;  // degrees of freedom of the noise's standard uncertainty
};

// The zero of one probe moved once, between two dwells (dwell_fit.h).
struct ZeroJump {
  std::size_t probe;
  std::size_t dwell;  // the first after it
  double size, u;     // m
};

struct StationMeans {
  std::vector<int> directions;                         // {+1, -1}, or the only one
  std::vector<double> stations;                        // m, ascending
  Eigen::VectorXd position;                            // m, per group
  Eigen::Matrix<double, kProbes, Eigen::Dynamic> gap;  // m, per group
  PerProbe<Eigen::MatrixXd> covariance;                // m^2, group x group, per probe
  std::vector<Dwell> dwells;                           // those of `stations`
  Eigen::Matrix<double, kProbes, Eigen::Dynamic>
      residual;                 // m, per dwell: dwell - mean of its group
  std::vector<ZeroJump> jumps;  // one more unknown each; they are no longer in dwells and residual
  Eigen::MatrixXd white;        // m^2, dwells x probes: variance of a dwell without its drift
  NoiseFigures noise;
  std::vector<std::string> notes;  // for the user, one sentence each

  Eigen::Index groups() const { return position.size(); }
};

// Where the passes scatter significantly more than the noise says: the noise that makes them most
// probable, or all covariances scaled up alike. The second takes no cause of the scatter for a
// drift: what shows in one probe, or at a few stations, keeps standing out for a diagnosis.
enum class ExcessNoise : unsigned char { kFitted, kScaled };

// `name` is the recording in messages.
StationMeans FitStations(const std::string& name, const SweepDwells& sweep, const ProbeNoise& noise,
                         ExcessNoise excess);

}  // namespace abbe::probes
