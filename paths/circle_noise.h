// What the noise of single readings does to the figures of a circle: they are ranges, so noise adds
// to them, and the more the more points there are.
//
//   const double noise = ReadingNoise(run);
//   EvaluateCircle(WithNoise(run, std::sqrt(3.0) * noise, 1));     // as if it were twice as large
//
// The noise of a radius is told from third differences of neighbouring readings, which a smooth
// path does not reach. A range grows with the noise: from once to twice as much by as much as it
// has grown from none to once. Units: m. Failure: none; without four readings in sequence the noise
// is 0. Source: the method of Cook and Stefanski, JASA 89 (1994). Validity: noise that is white
// from reading to reading; what is slower counts as path.
#pragma once

#include <cstdint>

#include "paths/circle_run.h"

namespace abbe::paths {

double ReadingNoise(const CircleRun& run);

// The run with normal noise on each radius and out of plane; `copy` tells one draw from another.
CircleRun WithNoise(const CircleRun& run, double deviation, std::uint64_t copy);

}  // namespace abbe::paths
