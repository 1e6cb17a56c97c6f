// The run-out of a turning shaft from readings of a probe at any angles: the block "bearing" of the
// linkage's pivots (relm/error_models.h) as a fit of its own.
//
//   const BearingHarmonics fit = FitBearing(shaft.angle, shaft.value, {1, 2}, shaft.time);
//   fit.result.Value("bearing.shaft_sin_1");
//   fit.At(angle);  fit.rms;
//
//   value = mean + sum over the orders n of s_n sin(n angle) + c_n cos(n angle)
//
// Order 1 is an eccentricity of the target on the shaft, 2 and above are form of the target and of
// the bearing. The noise is estimated from the residuals. With times its memory is too (row_memory.h),
// and the fit counts it: neighbouring readings are seldom independent. Without, or where they go on in
// another way (a vibration), u is larger by as much as sums of neighbours scatter more.
// Units: rad, m, s. Shapes: lists of one length, in the order of time; or no times.
// Failure: InputError for too few readings or orders below 1; NumericalError when the angles do not
// determine the harmonics (a short arc).
// Source: Boelens (2006), the Fourier sum of the bearing's roundness.
// Validity: one speed; a delay between probe and encoder turns into a phase.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "estimation/noise_memory.h"
#include "estimation/result.h"

namespace abbe::fusion {

struct BearingHarmonics {
  std::vector<int> orders;
  estimation::Result result;                           // blocks "mean" and "bearing"
  double rms = 0.0;                                    // m: of the residuals
  std::optional<estimation::NoiseMemory> memory = {};  // m, s: of the noise
  double correlated = 1.0;  // the factor on its deviation where it goes on in another way

  double At(double angle) const;      // m: the fitted value
  double Amplitude(int order) const;  // m
};

// `orders`: 1 and above, each once.
BearingHarmonics FitBearing(std::span<const double> angles, std::span<const double> values,
                            const std::vector<int>& orders, std::span<const double> times = {});

// The rms deviation of readings from a fit, m.
double RmsAbout(const BearingHarmonics& fit, std::span<const double> angles,
                std::span<const double> values);

}  // namespace abbe::fusion
