// Reading the CSV form of a recording.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "recording/recording.h"

namespace abbe::recording {

// Calls `use` for each block of a CSV recording, `rows` rows long except the last; `use` may
// move from it. The file is read once. InputError ("file:line: column: ...") for any
// violation of docs/recordings.md. A last line without a line end may be incomplete: it is
// dropped, with a warning in the last block.
void ReadCsv(const std::filesystem::path& path, std::size_t rows,
             const std::function<void(Recording& block)>& use);

// The recording without its rows.
Recording ReadCsvHead(const std::filesystem::path& path);

}  // namespace abbe::recording
