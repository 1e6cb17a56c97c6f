// How large the harmonics of a circle's radius are that the smooth errors of a machine make, beyond
// those that a cause of the signature table explains.
//
// The errors of a machine are functions of its position, the same in both senses and at any feed.
// Their harmonics of order 0 to 3 are centre, scale, squareness and bow; from order 4 on no cause
// explains them, yet they resemble the reversal spikes: the joint fit needs them as terms of their
// own (circle_causes.h).
//
//   const std::vector<double> sd = SmoothHarmonics(mill, run);   // sd[0] is that of order 4
//
// Each error function is a Gaussian process of the machine's population; the covariance of the
// radial deviation around the circle follows to first order from the volumetric error of the chain,
// its double Fourier transform gives the variance of each order.
// Units: m. Shapes: one standard deviation an order, of sine and cosine each, up to the last one
// above 1 nm or order kLastHarmonic. Failure: none. Source: own. Validity: first order; the ball
// stands in the machine's origin when all axes are at zero.
#pragma once

#include <vector>

#include "machine/machine.h"
#include "paths/circle_run.h"

namespace abbe::fusion {

inline constexpr int kFirstHarmonic = 4;
inline constexpr int kLastHarmonic = 40;

std::vector<double> SmoothHarmonics(const machine::Machine& machine, const paths::CircleRun& run);

}  // namespace abbe::fusion
