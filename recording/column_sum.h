// A column of a recording made of columns of a table: scaled, shifted, added.
//
//   counts*0.00549+3      a + b/2      "gap 1" - "gap 2"
//
// A sum of terms; a term is numbers and at most one column, joined by * or / (a column is never
// divided by). A name that is also a sum, or has blanks in it, is taken as a name where the table
// has it, else it stands in double quotes. Numbers have a point and stand in the unit of the new
// column; a column whose name ends in a unit is converted to that unit first.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::recording {

struct ColumnSum {
  struct Term {
    std::size_t column;  // of the table
    double factor;       // from the unit of the column to that of the new one included
  };
  std::vector<Term> terms;
  double offset = 0.0;

  // NaN where a cell has no number.
  double Of(const std::vector<double>& cells) const;
};

// InputError, beginning with `place`, for a text that is no such sum, for a column that the table
// lacks (it lists those it has) or has twice, and for a sum of no column.
ColumnSum ParseColumnSum(std::string_view text, std::string_view new_name,
                         const std::vector<std::string>& names, const std::string& place);

}  // namespace abbe::recording
