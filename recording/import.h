// Import of files of other programs as recordings: one line per format in the table of import.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// Data that the file itself does not contain.
struct ImportOptions {
  std::string axis;           // "X", "Y" or "Z": the axis that was measured; empty when not given
  double u_probing_um = 0.0;  // standard uncertainty of a hole centre; 0 when not given
};

// The recording from a file of another format, chosen by its extension; nothing when no importer
// has that extension. InputError of the importer for an invalid file.
std::optional<Recording> Import(const std::filesystem::path& path, const ImportOptions& options);

}  // namespace abbe::recording
