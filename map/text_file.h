// Whole text files.
// Failure: InputError with the path and the reason of the system.
#pragma once

#include <filesystem>
#include <string>

namespace abbe::map {

// Written by recording/whole_file.h. Missing folders are created.
void WriteWhole(const std::string& text, const std::filesystem::path& path);

// InputError when the file cannot be read.
std::string ReadWhole(const std::filesystem::path& path);

}  // namespace abbe::map
