// The rows of a recording that count, and their numbers in SI units.
//
//   const std::vector<std::size_t> rows = GoodRows(recording);           // of this block of it
//   const std::vector<double> x = ValuesOf(recording, "x_mm", rows);       // m
//
// A row counts when its flag is 0 (or there is no column `flags`).
// Failure: InputError naming file, row (from 1) and column: no row counts, a column is missing, or
// a number is not finite in a row that counts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::recording {

std::vector<std::size_t> GoodRows(const Recording& recording);
bool HasGoodRow(const Recording& recording);
// What GoodRows throws; `rows`: of the whole recording.
[[noreturn]] void RefuseNoGoodRow(const Recording& recording, std::size_t rows);

std::vector<double> ValuesOf(const Recording& recording, const std::string& column,
                             const std::vector<std::size_t>& rows);

}  // namespace abbe::recording
