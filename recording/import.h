// Files of others that become recordings: one line in the table of import.cpp for each.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// What the file itself does not say.
struct ImportOptions {
  std::string axis;           // "X", "Y" or "Z": the axis that was measured; empty when not given
  double u_probing_um = 0.0;  // standard uncertainty of a hole centre; 0 when not given
};

// The recording in a file of another's form, told by its extension; nothing when no importer takes
// that extension. InputError, by the importer, for a file that is not as it should be.
std::optional<Recording> Import(const std::filesystem::path& path, const ImportOptions& options);

}  // namespace abbe::recording
