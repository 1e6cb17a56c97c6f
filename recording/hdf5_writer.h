// Writing a complete recording as HDF5; row_file.h writes row by row.
#pragma once

#include <string>

#include "recording/recording.h"
#include "recording/whole_file.h"

namespace abbe::recording {

// Writes the columns of `recording`, compressed, under `header`; the caller calls file.Finish().
// Failures are those of WholeFile.
void WriteHdf5(const Recording& recording, const std::string& header, WholeFile& file);

}  // namespace abbe::recording
