// Results as data: one JSON object a file.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace abbe::apps {

// Writes a text, as recording/whole_file.h has it. Missing folders are made.
void WriteText(const std::string& text, const std::filesystem::path& path);

// The same with `result` (indented, numbers in shortest round-trip form).
void WriteResult(const nlohmann::ordered_json& result, const std::filesystem::path& path);

// InputError when the file cannot be read or is not JSON.
nlohmann::ordered_json ReadResult(const std::filesystem::path& path);

}  // namespace abbe::apps
