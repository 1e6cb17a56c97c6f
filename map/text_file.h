// Whole text files: written so that they are there complete or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace abbe::map {

// Under a temporary name, then renamed. Missing folders are made. InputError when it cannot be.
void WriteWhole(const std::string& text, const std::filesystem::path& path);

// InputError when the file cannot be read.
std::string ReadWhole(const std::filesystem::path& path);

}  // namespace abbe::map
