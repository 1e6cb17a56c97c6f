// The uncertainty of a cause with a shape that the data hardly know.
//
//   if (IsHardlyKnown(score)) score = OverAllShapes(without, score);
//
// Amplitude and time constant of a drift that is hardly bent are known together only, far from a
// normal distribution about what was found. Here all plausible shapes, evenly in the logarithm, are
// weighed by their likelihoods, each with the coefficients that fit it best whatever is usual of
// them; in the covariance two standard deviations about what was found, of the shape as a share of
// it, then hold 95 % of this mixture. Source: ISO/IEC Guide 98-3:2008/Suppl 1, 7.6 (a distribution
// instead of first order). Units: as in the score. Validity: the cause is linear in its
// coefficients, all else to first order.
#pragma once

#include "diagnosis/candidate.h"
#include "diagnosis/fit.h"

namespace abbe::diagnosis {

// Whether the logarithm of its free shape is known to less than a tenth.
bool IsHardlyKnown(const Score& score);

// `without`: a fit with everything else that was found. `score`: of the fit with the cause.
Score OverAllShapes(const Fit& without, Score score);

}  // namespace abbe::diagnosis
