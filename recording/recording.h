// What the hardware said, as it said it, with what is needed to read it again in ten years.
//
// A recording is a header (TOML: kind, machine, axis, start, sources, mounting, ...) and named
// columns of numbers. The name of a column ends in its unit (`probe_a_um`), and the numbers stay in
// that unit: a recording keeps what was said, whoever evaluates it converts. Both file forms (CSV
// for people, HDF5 for bulk) hold the same content; see docs/recordings.md.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "failure/failure.h"

namespace abbe::recording {

// Bits of the column `flags`; 0 is a good row.
enum Flag : std::uint32_t {
  kStale = 1,
  kOutOfRange = 2,
  kDeviceError = 4,
  kInterpolated = 8,
  kClockJump = 16,
};

struct Column {
  std::string name;
  std::vector<double> values;
};

struct Recording {
  std::string name;    // the file it came from, for messages
  std::string header;  // TOML text, without the leading "# " of the CSV form, one key a line
  std::vector<Column> columns;
  std::vector<std::string>
      warnings;               // e.g. "the file ends in the middle of row 812: that row is dropped"
  std::size_t first_row = 0;  // of the file: a block of a longer recording begins there

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }

  // The values of a column, or an empty optional.
  std::optional<std::span<const double>> Find(std::string_view column) const;
  // The values of a column; InputError naming the file and the column when it is missing.
  std::span<const double> At(std::string_view column) const;

  // A text of the header by dotted path ("kind", "mounting.head"), or an empty optional. Other TOML
  // values are returned as TOML writes them.
  std::optional<std::string> HeaderText(std::string_view path) const;
  // Numbers of the header; InputError naming the file and the key when it is none, is below
  // `at_least`, or there are not `count` of them.
  std::optional<double> HeaderNumber(
      std::string_view path, double at_least = -std::numeric_limits<double>::infinity()) const;
  std::optional<std::vector<double>> HeaderNumbers(std::string_view path, std::size_t count) const;
  std::string Kind() const;  // HeaderText("kind"); InputError when missing
  // Whether it says when its rows were, not only in which order (header time = "order").
  bool KnowsTimes() const;
};

}  // namespace abbe::recording
