// What keeps a finding from being certain, however large its evidence.
//
//   const HeldOutGain gain = HoldOut(campaign, recordings, causes);
//   AddDoubtsOfHeldOut(gain, diagnosis);        // all others Diagnose() has added
//
// Evidence is as good as the simulation is complete. A finding is doubtful whose U95 exceeds its
// size, whose size lies beyond what the cause can physically be, whose period is shorter than two
// steps of the path on which it was seen, which is a wave that fits nearly as well with another
// frequency, period or order, or with which the rows that were held out come out worse; outliers of
// several channels of one instrument are doubtful too. The probability is then kDoubtful at most,
// and a verdict of `explained` becomes `ambiguous`.
// Units: SI.
// Failure: none.
// Source: docs/theory-diagnosis.md.
// Validity: rules of thumb: each lowers a probability, none raises one.
#pragma once

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"

namespace abbe::diagnosis {

inline constexpr double kDoubtful = 0.5;

// What the findings themselves give cause for.
void AddDoubts(const simulation::Scene& scene, Diagnosis& diagnosis);
// What the rows that were held out give cause for; `gain`: of the findings that are modelled.
void AddDoubtsOfHeldOut(const HeldOutGain& gain, Diagnosis& diagnosis);

}  // namespace abbe::diagnosis
