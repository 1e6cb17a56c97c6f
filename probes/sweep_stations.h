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
// zero of a probe, or its warming up, is looked for (dwell_fit.h); where it is larger still, white noise,
// drift and its time are those that make the dwells most probable (restricted maximum likelihood,
// each within a factor of two of what was said before, normal in its logarithm).
//
// A reading in steps that noise and drift do not average out errs alike in all passes: the variance
// that no repetition shows (estimation/reading_step.h) is added for each station, half of it the
// same in both directions.
//
// Frames: none; gaps of the probes.
// Units: m, s. Shapes: those of station_means.h.
// Failure: InputError when fewer than three stations were approached from every direction of the
// sweep.
// Source: Aitken's generalised least squares; restricted maximum likelihood of the variances
// (estimation/markov_noise.h).
// Validity: a drift that is one Ornstein-Uhlenbeck process with a time between the dwells and the
// whole sweep; one move of a zero; others show in chi2. A wild dwell is found where others stand at
// the same place.
#pragma once

#include <string>
#include <vector>

#include "probes/head_settings.h"
#include "probes/station_means.h"
#include "probes/sweep_dwells.h"

namespace abbe::probes {

// Where the passes scatter significantly more than the noise says: moves of zeros and the noise that
// make them most probable, or all covariances scaled up alike. The second takes no cause of the
// scatter for a drift: what shows in one probe, or at a few stations, keeps standing out for a
// diagnosis. Where no second pass checks the noise, the first enlarges it (one_pass_drift.h).
enum class ExcessNoise : unsigned char { kFitted, kScaled };

// `name` is the recording in messages.
StationMeans FitStations(const std::string& name, const SweepDwells& sweep, const ProbeNoise& noise,
                         ExcessNoise excess);

// What moved in the zeros of probes, and the wild dwells, with where and when: one sentence each. `axis` is the swept one.
std::vector<std::string> MoveNotes(char axis, const StationMeans& means);

}  // namespace abbe::probes
