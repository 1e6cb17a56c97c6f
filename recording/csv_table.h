// Reads a table of numbers with one line of names (CSV of others) into a recording.
//
//   pose,arm,lS,lL,x_m
//   1,2,0.20,-1.17,0.391
//
//   ReadCsvTable("poses.csv", {.columns = {{"pivot_1_rad", "lS"}, {"ref_x_mm", "x_m"}},
//                              .where = {{"arm", "2"}}, .kind = "linkage"});
//
// Only the columns asked for are taken, each a column of the table or a sum of some
// (recording/column_sum.h). A column of the table whose name ends in a unit is converted to the
// unit of the new name; one without is taken to be in that unit. `where` keeps the rows in which a
// column says that, as text or number. Without the column time_s the rows are counted (time_s from
// 0 on, header time = "order"), those that are left out too. Lines that are empty or begin with #
// are passed over; a cell without a finite number makes its row flagged.
// As spreadsheets write it: cells are parted by the commas, semicolons or tabs of the first line,
// decimals have a point, or, where no comma parts cells, a comma; quotes round a cell, a byte order
// mark and CRLF do no harm. A table without a line of names takes them from `names`, "-" for a
// column to leave out; without `columns` all others are taken as they are.
// Failure: InputError with file, and line where there is one: no columns asked for, a name that the
// table lacks (it lists those it has), a line with another number of cells, no row left, no number
// in any.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "recording/monitor_log.h"
#include "recording/recording.h"

namespace abbe::recording {

struct CsvTableOptions {
  std::vector<MonitoredColumn> columns;  // new name, column or sum of columns of the table
  std::vector<std::pair<std::string, std::string>> where = {};  // column, what it says
  std::string kind;
  std::vector<std::string> names = {};  // of the table's columns, where it has no line of them
};

// Whether a file of the name *.csv is such a table: recordings begin with #.
bool IsCsvTable(const std::filesystem::path& path);

Recording ReadCsvTable(const std::filesystem::path& path, const CsvTableOptions& options);

}  // namespace abbe::recording
