// A path from a table of positions (compensation/position_table.h).
#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace abbe::apps {

// One column per point, m. InputError with file and line.
Eigen::Matrix3Xd ReadPathTable(const std::filesystem::path& file);

}  // namespace abbe::apps
