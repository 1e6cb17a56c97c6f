// Reading the CSV form of a recording.
#pragma once

#include <filesystem>

#include "recording/recording.h"

namespace abbe::recording {

// The content of a CSV recording. The file is read once, in blocks, so that memory is that of the
// numbers. InputError ("file:line: column: ...") for whatever is not as docs/recordings.md has it;
// a last line without a line end is dropped with a warning, for nobody can tell whether it is
// whole.
Recording ReadCsv(const std::filesystem::path& path);

}  // namespace abbe::recording
