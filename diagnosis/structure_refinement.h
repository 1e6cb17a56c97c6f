// A structure at its best: the borders of an interval, the number of terms of a smooth function,
// the wave of a line at which most is explained.
//
//   const Found best = Refined(fit, found.front());
//
// Units: SI. Failure: none; where nothing is better, what was given. Source: structure_question.h.
// Validity: the highest place near the one given.
#pragma once

#include "diagnosis/fit.h"
#include "diagnosis/structure_question.h"

namespace abbe::diagnosis {

Found Refined(const Fit& fit, Found found);
// An interval alone.
Found Sharpened(const Fit& fit, Found found);

// Radians of a wave from one that is tried to the next, over the range.
inline constexpr double kOfAWave = 0.4;

}  // namespace abbe::diagnosis
