// The runs that could be made next, of a campaign that was recorded.
//
//   for (const PossibleRun& run : PossibleRuns(campaign, recordings)) run.text;
//
// Again, with one thing changed, are the first sweep of each axis (order turned round, target
// mounted anew, an hour later and warmer) and the first run of the linkage that moves and the first
// that stands (at another feed, order turned round, base taken off and set up anew, other elbow, an
// hour later and warmer). New are gap steps and a standstill where there are sweeps, circles in
// three planes and of another radius where there is a linkage, and a length along each axis.
// Paths that were recorded are known to be free of collisions; new ones are the reader's to judge.
// Units: SI. A run that the linkage does not reach is left out.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "recording/recording.h"

namespace abbe::diagnosis {

struct PossibleRun {
  std::string text;    // what to do: "record gap steps of the X axis: ..."
  double seconds = 0;  // that it takes
  DiagnosedRun run;
};

// `recordings`: those of the campaign.
std::vector<PossibleRun> PossibleRuns(const Campaign& campaign,
                                      const std::vector<recording::Recording>& recordings);

}  // namespace abbe::diagnosis
