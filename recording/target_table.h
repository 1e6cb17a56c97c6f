// Import of target and cycle tables of ISO 230-2 tests, from test scripts of motion controllers,
// into a recording of kind "reference" with one axis.
//
//   UNIT=mm
//   CYCLES=5
//   POSITIONS=9
//   TGT_DATA[1]=-20                 target of position 1
//   REF_DATA_FWD[1,1]=-20.0492      reference reading at position 1 in cycle 1, going forwards
//   REF_DATA_BWD[1,1]=-20.0185      the same, going backwards
//
// Positions are counted from 1 in the order of forward motion; backwards the axis visits them in
// reverse order. Forwards is direction +1 when the targets ascend and -1 when they descend.
// Lines in any order; `#` starts a comment line; the first line may begin with `TEST_DATA=`;
// numbers may omit the zero before the point (`.0017`). UNIT is m, mm (also when absent) or um.
// CYCLES and POSITIONS may be absent. REF_PV and TGT_SET_PV become [sources] of the header; any
// other name is ignored with a warning.
//
// The recording is that of target_test.h.
//
// Failure: InputError with file and line for a line that is not an assignment, a value that
// is not a finite number, an unknown unit, an index out of range or given twice; InputError
// with the file for a file that cannot be read or has no readings, a missing target, or
// targets that neither ascend nor descend.
#pragma once

#include <filesystem>
#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// `axis` is "X", "Y" or "Z".
Recording ReadTargetTable(const std::filesystem::path& path, const std::string& axis = "X");

}  // namespace abbe::recording
