// Reading the HDF5 form of a recording.
#pragma once

#include <filesystem>

#include "recording/recording.h"

namespace abbe::recording {

// The content of an HDF5 recording. A file that its writer did not close (it was killed, or it
// still records) opens with a warning and the rows that were flushed; so does a file that was cut,
// with the rows before the cut, where its structure survives. InputError ("file: row N: column:
// ...") else.
Recording ReadHdf5(const std::filesystem::path& path);

}  // namespace abbe::recording
