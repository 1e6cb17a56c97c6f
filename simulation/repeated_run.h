// A recorded run made again, with one thing changed.
//
//   const AgainAbout about{"demo-mill", tomorrow, "id = \"as it was\"\n"};
//   const recording::Recording slower = AtFeed(Again(run, about), 0.2);
//
// The rows are those of the recording, readings included (planned_run.h replaces them). The header
// keeps what a simulation asks for: kind, axis and the rule of the dwells.
// Units: those of a recording. Shapes: rows of the run, or fewer.
// Failure: none.
// Validity: a path only: what the run would read, planned_run.h says.
#pragma once

#include <string>

#include "recording/recording.h"

namespace abbe::simulation {

struct AgainAbout {
  std::string machine;
  double started = 0.0;  // s since 1970
  std::string mounting;  // the lines of the table [mounting]; each kind has keys of its own
};
// The same path.
recording::Recording Again(const recording::Recording& run, const AgainAbout& about);

// From its end to its beginning, on the same way.
recording::Recording TurnedRound(recording::Recording run);

// So many times as fast.
recording::Recording AtFeed(recording::Recording run, double times);

// All recorded temperatures by so much.
recording::Recording Warmer(recording::Recording run, double kelvin);

// An hour later, the machine 3 K warmer.
inline constexpr double kWarmer = 3.0;  // K
// Again, an hour after `run` and warmer.
recording::Recording AnHourLater(const recording::Recording& run, AgainAbout about);

// The file name without folder and extension.
std::string ShortName(const recording::Recording& run);

}  // namespace abbe::simulation
