// The valid rows of a recording, and their values in SI units.
//
//   const std::vector<std::size_t> rows = GoodRows(recording);           // of one block
//   const std::vector<double> x = ValuesOf(recording, "x_mm", rows);       // m
//
// A row is valid when its flag is 0 or there is no column `flags`.
// Failure: InputError naming file, row (from 1) and column: no valid row, a missing column, or a
// value that is not finite in a valid row.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::recording {

// The numbers of the valid rows of this block, and whether there is one.
std::vector<std::size_t> GoodRows(const Recording& recording);
bool HasGoodRow(const Recording& recording);
// Throws the InputError of GoodRows; `rows`: number of rows of the whole recording.
[[noreturn]] void RefuseNoGoodRow(const Recording& recording, std::size_t rows);

// The values of a column in these rows, in SI units.
std::vector<double> ValuesOf(const Recording& recording, const std::string& column,
                             const std::vector<std::size_t>& rows);

}  // namespace abbe::recording
