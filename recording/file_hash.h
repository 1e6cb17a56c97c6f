// The SHA-256 of a file or of a text, which identifies data independently of the name of its file.
//
// Both return 64 hexadecimal digits, as sha256sum prints them. Failure: InputError when the file
// cannot be read. Source: FIPS 180-4, by libcrypto.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace abbe::recording {

std::string Sha256OfFile(const std::filesystem::path& path);  // in pieces, of any size
std::string Sha256OfText(std::string_view text);

}  // namespace abbe::recording
