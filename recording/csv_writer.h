// Writing the CSV form of a recording at once; row_file.h has the form that grows.
#pragma once

#include <string>

#include "recording/recording.h"
#include "recording/whole_file.h"

namespace abbe::recording {

// Writes the columns of `recording` under `header`; the caller finishes the file. Failures are
// those of WholeFile.
void WriteCsv(const Recording& recording, const std::string& header, WholeFile& file);

}  // namespace abbe::recording
