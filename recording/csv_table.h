// Import of a CSV table from other programs, with one line of column names, into a recording.
//
//   pose,arm,lS,lL,x_m
//   1,2,0.20,-1.17,0.391
//
//   ReadCsvTable("poses.csv", {.columns = {{"pivot_1_rad", "lS"}, {"ref_x_mm", "x_m"}},
//                              .where = {{"arm", "2"}}, .kind = "linkage"});
//
// Only the requested columns are read, each a column of the table or a sum of columns
// (recording/column_sum.h). A column whose name ends in a unit is converted to the unit of the new
// name; one without a unit is assumed to have that unit. `where` keeps the rows whose cell in a
// column equals a text or number. Rows are sorted by time_s. A column named order, an index of
// measurement without times, becomes time_s (header time = "order"). Without either, time_s is the
// row number from 0 (time = "order" too), in which excluded rows count; not where the rows are
// `shuffled`: such a recording has no time_s. Lines that are empty or begin with # are ignored; a
// row with a cell that is not a finite number is flagged.
// Format, as written by spreadsheets: the cells are separated by commas, semicolons or tabs, as in
// the first line; decimals have a point, or a comma unless commas separate the cells; quotes round
// a cell, a byte order mark and CRLF are accepted. A table without a line of names takes them from
// `names`, "-" for a column to leave out; without `columns` all the others are read unchanged.
// Failure: InputError with file and line, if there is one: no columns requested, a name that the
// table lacks (the message lists its columns), a line with a wrong number of cells, no row left, no
// row with a number in every column.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "recording/monitor_log.h"
#include "recording/recording.h"

namespace abbe::recording {

struct CsvTableOptions {
  std::vector<MonitoredColumn> columns;  // new name; column or sum of columns of the table
  std::vector<std::pair<std::string, std::string>> where = {};  // column, required cell
  std::string kind;
  std::vector<std::string> names = {};  // of the columns of a table without a line of names
  bool shuffled = false;                // the order of the rows is not that of measurement
};

// Whether the file is *.csv and not a recording, which begins with #.
bool IsCsvTable(const std::filesystem::path& path);

Recording ReadCsvTable(const std::filesystem::path& path, const CsvTableOptions& options);

}  // namespace abbe::recording
