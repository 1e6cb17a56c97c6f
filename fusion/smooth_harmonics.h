// Prior standard deviations of the harmonics of a circle's radius that the smooth errors of a
// machine have beyond the causes of the signature table.
//
// The errors of a machine are functions of its position, equal in both senses and at any feed.
// Their harmonics of order 0 to 3 are centre, scale, squareness and bow. Those from order 4 on
// match no cause but resemble reversal spikes, so they are nuisance parameters of the joint fit
// (circle_causes.h).
//
//   const std::vector<double> sd = SmoothHarmonics(mill, run);   // sd[0] is that of order 4
//
// Each error function is a Gaussian process of the machine's population; the covariance of the
// radial deviation around the circle follows to first order from the volumetric error of the chain,
// its double Fourier transform gives the variance of each order.
// Units: m. Shapes: one standard deviation an order, of sine and cosine each, up to the last one
// above 1 nm or order kLastHarmonic.
// Failure: none.
// Source: own.
// Validity: first order; the ball is at the machine's origin when all axes are at zero.
#pragma once

#include <vector>

#include "machine/machine.h"
#include "paths/circle_run.h"

namespace abbe::fusion {

inline constexpr int kFirstHarmonic = 4;
inline constexpr int kLastHarmonic = 40;

// `run`: its circle and the place of its centre.
std::vector<double> SmoothHarmonics(const machine::Machine& machine, const paths::CircleRun& run);

}  // namespace abbe::fusion
