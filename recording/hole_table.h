// Import of the hole table of a coordinate measuring machine, measured and nominal, into a
// recording of kind "plate" with one set-up.
//
//   Plug Plate: 1597A
//       Meas X    Meas Y     Nom X     Nom Y     Err X ...
//      -72.940   121.734   -73.140   121.705     0.200 ...
//
// Lines before the line of names are ignored. Names are separated by at least two blanks or a tab,
// numbers by at least one; Meas X, Meas Y, Nom X and Nom Y are required, other columns are ignored.
// Numbers are in mm. The recording has the columns x_mm, y_mm (measured), z_mm (0), setup (1), hole
// (counted from 1 in the order of the file), plate_x_mm, plate_y_mm (nominal). Its header has
// u_probing_um if the argument `u_probing_um` is above 0; the table does not state it.
// Failure: InputError with file and line for a word that is not a finite number or a row of a wrong
// length; with the file when it cannot be read or has no such line of names, or no row.
#pragma once

#include <filesystem>

#include "recording/recording.h"

namespace abbe::recording {

Recording ReadHoleTable(const std::filesystem::path& path, double u_probing_um);

}  // namespace abbe::recording
