// The search for causes, with noise that has a memory as a hypothesis of its own.
//
//   answer = BesideMemory(std::move(answer));
//
// Where the search leaves nothing, its answer stands: nothing else is computed. Else the memory of
// each run of the linkage and of each run with a reference instrument is estimated from what the
// simulation leaves without causes (estimation/noise_memory.h), where it is more probable than
// white noise by kShown in the logarithm, and the search is repeated with runs whitened by it.
// The answer is the one with the larger marginal likelihood, its causes and memories counted with
// their prior probabilities. The memory of a run fades within kMostSteps rows, slower ones are a
// drift, which is no noise; and a run that leaves more than is stated scatters (scatter.h),
// with a memory or without.
// Failure: that of Fit.
#pragma once

#include "diagnosis/answer.h"

namespace abbe::diagnosis {

Answer BesideMemory(Answer white);

}  // namespace abbe::diagnosis
