// What keeps a finding from being certain, however large its evidence.
//
//   AddDoubts(campaign.scene(), gain, diagnosis);        // after Diagnose and HoldOut
//
// Evidence is as good as the simulation is complete. A finding is doubtful whose U95 exceeds its
// size, whose size lies beyond what the cause can physically be, whose period is shorter than two
// steps of the path on which it was seen, or with which the rows that were held out come out worse;
// outliers of several channels of one instrument are doubtful too. The probability is then kDoubtful
// at most, and a verdict of `explained` becomes `ambiguous`.
// Units: SI.
#pragma once

#include "diagnosis/diagnose.h"
#include "diagnosis/hold_out.h"

namespace abbe::diagnosis {

inline constexpr double kDoubtful = 0.5;

void AddDoubts(const simulation::Scene& scene, const HeldOutGain& gain, Diagnosis& diagnosis);

}  // namespace abbe::diagnosis
