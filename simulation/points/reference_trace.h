// The traces of runs whose rows are points of the machine (simulation/trace.h): those with a
// reference instrument, of lengths and of plates.
//
// In a positioning test the tested axis heads as the column `direction` says, also where it comes
// back to a target from the other side; a play is taken up at each target. How far beyond its last
// target it turned is not known, so it last reversed kLongAgo. In other runs the axes head as they
// move. Of runs of lengths and plates nothing is known of the way to their rows, so no axis has a
// heading. Without the column time_s a row counts as a second.
// Units: m, s. Shapes: one column a point.
// Failure: InputError with the recording's name for a start that is no time.
// Source: ISO 230-2 for the approaches of a positioning test.
// Validity: the way between two rows is not recorded.
#pragma once

#include "recording/recording.h"
#include "simulation/points/machine_points.h"
#include "simulation/points/reference_run.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// A run with a reference instrument.
Trace TraceOf(const recording::Recording& recording, const ReferenceRun& run);
// For lengths and plates. Headings are those of the columns approach_x, approach_y, approach_z; 0
// without one.
Trace TraceOf(const recording::Recording& recording, const MachinePoints& points);

// Where a recording of either has none of these columns.
void NoteUnknownApproach(const recording::Recording& recording, std::vector<std::string>& notes);

}  // namespace abbe::simulation
