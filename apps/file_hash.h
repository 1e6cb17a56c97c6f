// The SHA-256 of a file, which identifies data independently of the file name.
#pragma once

#include <filesystem>
#include <string>

namespace abbe::apps {

// 64 hexadecimal digits, as sha256sum prints them. InputError when the file cannot be read.
std::string Sha256Of(const std::filesystem::path& path);

}  // namespace abbe::apps
