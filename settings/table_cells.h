// The cells of a table as spreadsheets write it.
//
//   const char separator = settings::SeparatorOf("X [mm];Y [mm]");             // ';'
//   const auto cells = settings::CellsOf("1,5;\"left; upper\"", separator);    // two
//   settings::Unquoted(cells[1]);                                              // left; upper
//   settings::WithDecimalPoint(cells[0], separator);                           // "1.5"
//
// Units: none. Failure: none. Validity: UTF-8.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace abbe::settings {

// The first line of a file without the byte order mark that may stand before it.
std::string_view WithoutByteOrderMark(std::string_view line);

// The separator between the cells: spreadsheets write semicolons where numbers have a decimal comma.
char SeparatorOf(std::string_view line);

// The cells of a line as they stand, without the blanks around them; a separator inside quotes
// belongs to its cell.
std::vector<std::string_view> CellsOf(std::string_view line, char separator);

// Without the quotes and the blanks inside them; a doubled quote inside quotes is one.
std::string Unquoted(std::string_view cell);

// A number with its decimal comma as a point. In a table separated by commas "1,5" occurs only in
// quotes, may mean 15, and stays.
std::string WithDecimalPoint(std::string_view number, char separator);

}  // namespace abbe::settings
