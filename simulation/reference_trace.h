// The trace of a run with a reference instrument (simulation/trace.h), kind "reference".
//
// In a positioning test the tested axis heads as the column `direction` says, also where it comes
// back to a target from the other side; a play is taken up at each target. How far beyond its last
// target it turned is not known, so it last reversed kLongAgo. In other runs the axes head as they
// move. Of a run of lengths (kind "length") nothing is known of the way to its rows, so no axis has
// a heading. Failure: InputError with the recording's name for a start that is no time.
#pragma once

#include "recording/recording.h"
#include "simulation/reference_run.h"
#include "simulation/trace.h"

namespace abbe::simulation {

Trace TraceOf(const recording::Recording& recording, const ReferenceRun& run);
Trace TraceOfLengths(const recording::Recording& recording);

}  // namespace abbe::simulation
