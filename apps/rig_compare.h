// abbe rig compare: comparison of results with the truth of the rig.
#pragma once

#include <filesystem>
#include <vector>

namespace abbe::apps {

// Prints each result, the JSON of a sweep or of a diagnosis, with the truth. Returns the exit code.
int CompareWithTruth(const std::filesystem::path& truth,
                     const std::vector<std::filesystem::path>& results);

}  // namespace abbe::apps
