// How well the readings of a turning shaft repeat from turn to turn, and which way it turns.
//
//   const RimRepeats repeats = RepeatsOf(run);
//   if (run.sense == 0) SetSense(repeats.sense, run);
//
// The rows of each sensor are taken apart by least squares as
//
//   offset of each turn  +  sum over the orders n <= kRepeatedOrders of waves of n shaft  +  noise
//
// so that what every turn repeats and what drifts from turn to turn is no noise. What is left, over
// its degrees of freedom f, is the scatter; its variance is that of Student's distribution, f / (f
// - 2) times as large. Neighbouring rows share some of it (what shakes for longer than a row, a
// late stamp): a slow wave is known no better than the variance times 1 + 2 sum of r_k allows, r_k
// the correlation of rows k apart, up to the first one that noise alone would show. Rows count with
// that variance, as if they were independent. `sense`: 1 or -1, in which the once to four times per
// turn of the sensors is more as if one rim went by them all; 1 where that is the same (one sensor,
// or two opposite ones).
// Units: m. Shapes: one scatter a sensor.
// Failure: none; with too few turns the lists are empty.
// Validity: one speed in a run; what repeats more often than kRepeatedOrders per turn counts as
// noise.
// Source of the inflation: Geyer, Statistical Science 7 (1992), integrated correlation.
#pragma once

#include <Eigen/Core>

#include "simulation/shaft/shaft_run.h"

namespace abbe::simulation {

inline constexpr int kRepeatedOrders = 12;
inline constexpr double kLeastTurns = 2.0;

struct RimRepeats {
  int sense = 1;
  double turns = 0.0;           // the fewest that a sensor saw
  Eigen::VectorXd scatter, sd;  // of each sensor: of a row; with which a row counts
  Eigen::Index freedom = 0;     // of the sensor with fewest
};

// Noise needs kLeastTurns turns: with fewer `scatter` and `sd` are empty.
RimRepeats RepeatsOf(const ShaftRun& run);

}  // namespace abbe::simulation
