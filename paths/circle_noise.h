// The effect of the noise of single readings on the figures of a circle: they are ranges, so noise
// increases them, and the more, the more points there are.
//
//   const double noise = ReadingNoise(run);
//   EvaluateCircle(WithNoise(run, std::sqrt(3.0) * noise, 1));     // as if it were twice as large
//
// The noise of a radius is estimated from third differences of neighbouring readings, to which a
// smooth path contributes little. The figure without noise follows by extrapolation: doubling the
// noise increases a range by as much as the noise itself did. Units: m. Failure: none; without four
// readings in sequence the noise is 0. Source: simulation extrapolation, Cook and Stefanski, JASA
// 89 (1994). Validity: noise that is white from reading to reading; slower noise counts as path.
#pragma once

#include <cstdint>

#include "paths/circle_run.h"

namespace abbe::paths {

// The standard deviation of one radius, m.
double ReadingNoise(const CircleRun& run);

// The run with normal noise on each radius and out of plane; `copy`: number of the draw.
CircleRun WithNoise(const CircleRun& run, double deviation, std::uint64_t copy);

}  // namespace abbe::paths
