// A path from a table: the columns x_mm, y_mm, z_mm of a CSV, in any order among others.
#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace abbe::apps {

// One column per point, m. InputError with file and line.
Eigen::Matrix3Xd ReadPathTable(const std::filesystem::path& file);

}  // namespace abbe::apps
