// Reading the CSV form of a recording.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "recording/recording.h"

namespace abbe::recording {

// The blocks of a CSV recording, each of `rows` rows but the last, which `use` may take.
// The file is read once. InputError ("file:line: column: ...") for whatever is not as
// docs/recordings.md has it; a last line without a line end is dropped with a warning in the last
// block, for nobody can tell whether it is whole.
void ReadCsv(const std::filesystem::path& path, std::size_t rows,
             const std::function<void(Recording& block)>& use);

// The same without its rows.
Recording ReadCsvHead(const std::filesystem::path& path);

}  // namespace abbe::recording
