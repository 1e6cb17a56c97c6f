// Reading the HDF5 form of a recording.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "recording/recording.h"

namespace abbe::recording {

// The blocks of an HDF5 recording, each of `rows` rows but the last, which `use` may take. A file
// that its writer did not close (it was killed, or it still records) opens with a warning in the
// last block and the rows that were flushed. InputError ("file: row N: column: ...") for whatever
// is not as docs/recordings.md has it, and for a file that was cut after it had been closed: its
// missing numbers cannot be told from zeros.
void ReadHdf5(const std::filesystem::path& path, std::size_t rows,
              const std::function<void(Recording& block)>& use);

// The same without its rows.
Recording ReadHdf5Head(const std::filesystem::path& path);

}  // namespace abbe::recording
