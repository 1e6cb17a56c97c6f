// A column of a recording computed as a linear combination of columns of a table.
//
//   counts*0.00549+3      a + b/2      "gap 1" - "gap 2"
//
// A sum of terms; a term is a product or quotient of numbers and at most one column, which cannot
// be a divisor. A column name that contains blanks or operators is recognised if the table has it,
// or when written in double quotes. Numbers have a decimal point and the unit of the new column; a
// column whose name ends in a unit (length_mm, "length [mm]", "length (mm)", "length / mm") is
// converted to the unit of the new column first.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::recording {

struct ColumnSum {
  struct Term {
    std::size_t column;  // of the table
    double factor;       // includes the conversion to the unit of the new column
  };
  std::vector<Term> terms;
  double offset = 0.0;
  std::vector<std::string> notes;  // of endings that look like a unit and are taken for none

  // The value for one row of the table; NaN if a cell has no number.
  double Of(const std::vector<double>& cells) const;
};

// InputError, beginning with `place`, for a text that is not such a sum, for a sum without a
// column, for a column that the table has twice or not at all (the message lists its columns), and
// for one whose unit measures another thing than that of the new column.
ColumnSum ParseColumnSum(std::string_view text, std::string_view new_name,
                         const std::vector<std::string>& names, const std::string& place);

}  // namespace abbe::recording
