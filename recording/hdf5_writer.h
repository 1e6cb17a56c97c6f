// Writing the HDF5 form of a recording at once; row_file.h has the form that grows.
#pragma once

#include <filesystem>
#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// Writes the columns of `recording` under `header` to `path`, over what is there, with compressed
// columns. DeviceError when the disk takes no more, InputError when the file cannot be created.
void WriteHdf5(const Recording& recording, const std::string& header,
               const std::filesystem::path& path);

}  // namespace abbe::recording
