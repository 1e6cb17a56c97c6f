// Reading the HDF5 form of a recording.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "recording/recording.h"

namespace abbe::recording {

// Calls `use` for each block of an HDF5 recording, `rows` rows long except the last; `use` may
// move from it. A file that its writer did not close (it was killed, or it still records) has its
// flushed rows and a warning in the last block. InputError ("file: row N: column: ...") for any
// violation of docs/recordings.md, and for a file that was truncated after it had been closed:
// its missing numbers would read as zeros.
void ReadHdf5(const std::filesystem::path& path, std::size_t rows,
              const std::function<void(Recording& block)>& use);

// The recording without its rows.
Recording ReadHdf5Head(const std::filesystem::path& path);

}  // namespace abbe::recording
