// Writing a complete recording as CSV; row_file.h writes row by row.
#pragma once

#include <string>

#include "recording/recording.h"
#include "recording/whole_file.h"

namespace abbe::recording {

// Writes the columns of `recording` under `header`; the caller calls file.Finish(). Failures are
// those of WholeFile.
void WriteCsv(const Recording& recording, const std::string& header, WholeFile& file);

}  // namespace abbe::recording
