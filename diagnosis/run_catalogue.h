// The runs that could be made next, of a campaign that was recorded.
//
//   for (const PossibleRun& run : PossibleRuns(campaign, recordings)) run.text;
//
// Each kind of run proposes its own (simulation/run_kind.h): a recorded run repeated with one thing
// changed, or a new path. Paths that were recorded are known to be free of collisions; new ones are
// the reader's to judge.
// Units: SI. A run that the linkage does not reach is left out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/campaign.h"
#include "recording/recording.h"

namespace abbe::diagnosis {

struct PossibleRun {
  std::string text;    // what to do: "record gap steps of the X axis: ..."
  double seconds = 0;  // that it takes
  PreparedRun run;
  recording::Recording path;  // as it is planned, with the readings of a perfect machine
};

// `recordings`: those of the campaign.
std::vector<PossibleRun> PossibleRuns(const Campaign& campaign,
                                      const std::vector<recording::Recording>& recordings);

// The same and those to begin with, for runs that begin as `about` says; `wanted`: of which kinds.
using WantedKind = std::function<bool(const simulation::RunKind& kind)>;
std::vector<PossibleRun> PossibleRuns(const Campaign& campaign,
                                      const std::vector<recording::Recording>& recordings,
                                      const simulation::PathAbout& about, const WantedKind& wanted);

}  // namespace abbe::diagnosis
