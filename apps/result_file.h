// Results as data: one JSON object per file.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace abbe::apps {

// Writes a text by recording/whole_file.h. Missing folders are created.
void WriteText(const std::string& text, const std::filesystem::path& path);

// Writes `result` as indented JSON, numbers in shortest round-trip form.
void WriteResult(const nlohmann::ordered_json& result, const std::filesystem::path& path);

// InputError when the file cannot be read or is not JSON.
nlohmann::ordered_json ReadResult(const std::filesystem::path& path);

}  // namespace abbe::apps
