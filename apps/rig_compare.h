// abbe rig compare: how near results came to what the rig knows.
#pragma once

#include <filesystem>
#include <vector>

namespace abbe::apps {

// Prints each result, the JSON of a sweep or of a diagnosis, beside the truth. The exit code.
int CompareWithTruth(const std::filesystem::path& truth,
                     const std::vector<std::filesystem::path>& results);

}  // namespace abbe::apps
