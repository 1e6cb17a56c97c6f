// Correction of measured coordinates: the readings of the scales become positions of the tool.
//
// The table is a CSV with the columns x_mm, y_mm, z_mm in any order among others; `#` lines
// before the header and all other columns are copied. Every position p becomes Made(p)
// (corrector.h) plus the column of `beside`, the displacement of the axes in that row that is not
// in the map (3 x rows, m; empty: none).
// Units: mm in the file. Failure: InputError with file and line for a missing column, a row of a
// wrong length, a word that is not a number, a position outside the travels.
#pragma once

#include <string>
#include <string_view>

#include "compensation/corrector.h"

namespace abbe::compensation {

struct CorrectedTable {
  std::string text;
  std::size_t rows = 0;
  double largest = 0.0;  // largest correction, m
};

CorrectedTable CorrectTable(std::string_view text, const std::string& file,
                            const Corrector& corrector, const Eigen::Matrix3Xd& beside = {});

}  // namespace abbe::compensation
