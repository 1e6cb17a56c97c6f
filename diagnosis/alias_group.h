// Waves that the runs cannot tell apart: their sampling shows them all alike, or nearly so.
//
//   if (MayHaveAliases(score)) score = AmongAliases(without, std::move(score));
//   score.one_of;                        // empty: nothing else fits nearly as well
//
// All frequencies, periods or orders that stand out in what is left without the cause are scored
// beside the one found. Those whose evidence comes near that of the best are one group, none of
// which is certain. What is as near to the one found as a single piece of the runs can tell widens
// its U95 instead. Units: as in the score. Validity: to first order at `without`; what that leaves
// out grows with the wave, and so does what counts as near.
#pragma once

#include "diagnosis/candidate.h"
#include "diagnosis/fit.h"

namespace abbe::diagnosis {

// A wave, or a cause with a frequency that is one of a few.
bool MayHaveAliases(const Score& score);

// `without`: a fit with everything else that was found. `score`: of the fit with the cause.
Score AmongAliases(const Fit& without, Score score);

}  // namespace abbe::diagnosis
