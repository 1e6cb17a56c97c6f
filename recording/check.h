// Validation of a recording: the rules of docs/recordings.md for its kind.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "recording/recording.h"

namespace abbe::recording {

// Positions in the file of a recording, for messages: "runs/a.csv:17", or "runs/a.h5: row 5".
struct Places {
  std::string file;
  std::size_t header_line = 0;     // line number of the first line of the header; 0: HDF5
  std::size_t first_row_line = 0;  // line number of the first row; 0: HDF5

  std::string Header(std::size_t line) const;  // from 1
  std::string Row(std::size_t row) const;      // from 0; printed from 1
};

// Throws InputError for invalid column names: none at all, a duplicate, or one that is empty,
// contains a comma, a semicolon, a quote, a slash or a control character, begins with '#',
// has blanks at its ends, or is not UTF-8.
void CheckColumnNames(const std::vector<std::string>& names, std::string_view place);

// The kinds that a header may state.
std::vector<std::string_view> KnownKinds();
// A column of each that a kind requires; of several names that would do the first.
std::vector<std::string> RequiredColumns(std::string_view kind);

// Throws InputError when the header is not TOML, its kind is unknown, or `names` lack a column that
// the kind requires.
void CheckHeader(const std::string& header, const std::vector<std::string>& names,
                 const Places& places);

// The rules for rows, over the blocks of a recording one after the other: columns of equal length,
// time that never decreases, known flags, and no NaN, infinity or impossible value in a row without
// a flag, in the columns that abbe knows. Other columns are not checked.
// Throws InputError naming place and column.
class RowCheck {
 public:
  explicit RowCheck(Places places) : places_(std::move(places)) {}
  void Take(const Recording& block);

 private:
  Places places_;
  double time_ = -std::numeric_limits<double>::infinity();  // of the last row
};

// Throws InputError, naming place and column, unless the recording obeys every rule for names,
// header and rows.
void Check(const Recording& recording, const Places& places);

}  // namespace abbe::recording
