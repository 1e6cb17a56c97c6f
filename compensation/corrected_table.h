// Correction of measured coordinates: the readings of the scales become positions of the tool.
//
// The table is one of positions (position_table.h); `#` lines and all other columns are copied.
// Every position p becomes MadeOfReading(p) (corrector.h) plus the column of `beside`, the
// displacement of the axes in that row that is not in the map (3 x rows, m; empty: none).
// Units: those of the table. Failure: InputError with file and line for what PositionTable refuses
// and a position outside the travels.
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
