// Directions of the machine by name, as in a machine file.
//
// Frames: "x", "-z" are the unit vectors of the machine frame M; a rotation is given by the
// directions of the axes of a frame F, `rotation = ["y", "-x", "z"]`, which are the columns of
// R_MF.
// Units: none; unit vectors. Shapes: a direction 3 x 1, R_MF 3 x 3.
// Failure: InputError with the line for a word that is not a direction, or for three that are not a
// right-handed frame.
// Validity: along the axes of M only; a slanted direction cannot be written.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::machine {

// The unit vector from `key`, in M.
Eigen::Vector3d ReadDirection(const settings::Table& table, const char* key,
                              const std::string& fallback);

// R_MF from the key `rotation`.
Eigen::Matrix3d ReadRotation(const settings::Table& table,
                             const std::vector<std::string>& fallback);

}  // namespace abbe::machine
