// A table of positions, read row by row: a CSV with the columns x_mm, y_mm, z_mm in any order among
// others, or with the unit as coordinate measuring machines and spreadsheets state it: "X [mm]",
// "Y (um)", "z / inch". Semicolons or tabs may stand for the commas; then a decimal comma is one, and
// where one number of the table has it, all that are written do.
// `#` lines and empty ones are no rows.
//
//   compensation::PositionTable table("x_mm,y_mm,z_mm\n1,2,3\n", "points.csv");
//   while (table.Next()) {
//     if (table.IsRow()) table.Position();  // m
//   }
//
// Units: m. Failure: InputError with file and line for a missing column, two of one axis, one without
// a unit of length, a row of a wrong length, a word that is not a number, no row at all, and for a
// text that is not UTF-8.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "map/words.h"

namespace abbe::compensation {

class PositionTable {
 public:
  // The text must outlive the table. Only the axes that are `needed` must have a column; another
  // without one stands at 0.
  PositionTable(std::string_view text, const std::string& file,
                const std::array<bool, 3>& needed = {true, true, true});

  // Goes to the next line; false after the last. InputError if there was no line of names or no row.
  bool Next();
  // As it stands, without its end.
  std::string_view line() const { return line_; }
  // The end of the line as it stands: "\n" or "\r\n".
  std::string_view End() const;
  // Whether the line has a position; else it is a comment, empty or the names.
  bool IsRow() const { return row_; }
  // The position of the row, m.
  const Eigen::Vector3d& Position() const { return position_; }
  // The row with another position, in its own units, separators and decimals.
  std::string WithPosition(const Eigen::Vector3d& position) const;
  // "file:12".
  std::string Where() const { return lines_.Where(); }

 private:
  static constexpr std::size_t kNone = -1;

  void TakeNames(std::string_view names);
  void RefuseTwoOf(char axis, const std::vector<std::string>& columns) const;
  bool HasDecimalCommas() const;
  void TakeRow();

  std::string_view text_;
  map::Lines lines_;
  std::string file_;
  std::string_view line_;
  bool row_ = false, named_ = false, has_rows_ = false, has_decimal_commas_ = false;
  char separator_ = ',';
  std::size_t width_ = 0;
  std::array<bool, 3> needed_;
  std::array<std::size_t, 3> columns_{};  // kNone: there is none
  std::array<double, 3> si_{};
  std::vector<std::string_view> words_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
};

}  // namespace abbe::compensation
