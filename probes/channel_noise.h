// What one channel shows while the axis stands: its mean, its noise, the pickup of the mains.
//
// Method. A sine of 50 Hz and one of 60 Hz, each with the mean, are fitted by least squares at the
// times of the readings; the one that explains more is the pickup where its amplitude exceeds that
// of white noise at 0.1 % (amplitude^2 > -4 ln(0.001) noise^2 / n). The noise is what is left, as a
// standard deviation. A rate below twice the mains is no matter, unless it divides the mains
// without rest: then pickup is a constant.
//
// Units: those of the readings; s, Hz. Shapes: as many times as values.
// Source: the distribution of the amplitude of a sine fitted to white noise (Rayleigh).
// Validity: a sine that stands still in phase over the readings; harmonics count as noise.
// Failure: none; without readings the mean is NaN.
#pragma once

#include <cstddef>
#include <span>

namespace abbe::probes {

struct ChannelNoise {
  std::size_t readings = 0;
  double mean = 0.0;
  double noise = 0.0;     // standard deviation of one reading, without the mains
  double mains = 0.0;     // amplitude; 0: none beyond chance
  double mains_hz = 0.0;  // 50 or 60
  bool constant = false;  // two readings or more, all the same
};

// `values` may contain NaN, which are left out.
ChannelNoise NoiseOf(std::span<const double> times, std::span<const double> values);

}  // namespace abbe::probes
