// Directions of the machine by name, as a machine file gives them.
//
// Frames: "x", "-z" are the unit vectors of the machine frame M; a rotation is named by where the
// axes of a frame F point, `rotation = ["y", "-x", "z"]`, and its columns are those vectors: R_MF.
// Failure: InputError with the line for a word that names no direction, or for three that are not a
// right-handed frame.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::machine {

Eigen::Vector3d ReadDirection(const settings::Table& table, const char* key,
                              const std::string& fallback);

// R_MF from the key `rotation`.
Eigen::Matrix3d ReadRotation(const settings::Table& table,
                             const std::vector<std::string>& fallback);

}  // namespace abbe::machine
