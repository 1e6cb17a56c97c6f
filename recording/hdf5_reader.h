// Reading the HDF5 form of a recording.
#pragma once

#include <filesystem>

#include "recording/recording.h"

namespace abbe::recording {

// The content of an HDF5 recording. A file that its writer did not close (it was killed, or it
// still records) opens with a warning and the rows that were flushed. InputError ("file: row N:
// column:
// ...") for whatever is not as docs/recordings.md has it, and for a file that was cut after it had
// been closed: its missing numbers cannot be told from zeros.
Recording ReadHdf5(const std::filesystem::path& path);

}  // namespace abbe::recording
