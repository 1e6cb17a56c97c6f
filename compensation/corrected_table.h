// Measured coordinates, corrected: what the scales read becomes where the tool was.
//
// A CSV with the columns x_mm, y_mm, z_mm in any order among others; `#` lines before the header
// and all other columns are passed on as they are. Every position p becomes Made(p) (corrector.h).
// Units: mm in the file. Failure: InputError with file and line for a missing column, a row of
// another length, a word that is no number, a position outside the travels.
// `beside`: what the axes did beside their map in each row, m; empty: nothing.
#pragma once

#include <string>
#include <string_view>

#include "compensation/corrector.h"

namespace abbe::compensation {

struct CorrectedTable {
  std::string text;
  std::size_t rows = 0;
  double largest = 0.0;  // correction, m
};

CorrectedTable CorrectTable(std::string_view text, const std::string& file,
                            const Corrector& corrector, const Eigen::Matrix3Xd& beside = {});

}  // namespace abbe::compensation
