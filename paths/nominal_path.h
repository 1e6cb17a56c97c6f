// A nominal path from a file: CSV with the columns x_mm, y_mm and z_mm, one point a row, straight
// pieces between them.
//
//   x_mm,y_mm,z_mm
//   0,0,0
//   25,0,0
//
// Further columns, lines that begin with # and blanks around a field are ignored. Units: m in the
// result, axis coordinates. Failure: InputError with file and line.
#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace abbe::paths {

Eigen::Matrix3Xd ReadNominalPath(const std::filesystem::path& path);

}  // namespace abbe::paths
