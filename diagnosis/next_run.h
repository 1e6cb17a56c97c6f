// The run to make next, where rivals are left: of all that could be made, the one that is expected
// to tell them apart.
//
//   AddNextRuns(campaign, recordings, diagnosis);
//   diagnosis.findings[0].next_run->text;     // "repeat 04_circle_XY at 120 mm/min instead of 600"
//
// The runs are those of run_catalogue.h, simulated on the machine that the diagnosis fitted;
// expected_odds.h tells what each would bring, everything else that the simulation could be and the
// other findings projected out. Proposed is the shortest run after which the right rival is
// expected to be kCertain; where none is, the one that brings most, if it brings anything.
// Units: s; probabilities. Shapes: one proposal a finding with rivals.
// Failure: that of LinearRuns.
// Source: expected information: Lindley, Ann. Math. Statist. 27 (1956).
// Validity: first order on the fitted machine; a rival outside the catalogue is not among them.
#pragma once

#include <vector>

#include "diagnosis/diagnose.h"
#include "recording/recording.h"

namespace abbe::diagnosis {

// `recordings`: those of the campaign.
void AddNextRuns(const Campaign& campaign, const std::vector<recording::Recording>& recordings,
                 Diagnosis& diagnosis);

}  // namespace abbe::diagnosis
