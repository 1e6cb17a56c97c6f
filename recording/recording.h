// A recording: raw readings of the hardware, with the metadata to evaluate them again in ten years.
//
// A recording is a header (TOML: kind, machine, axis, start, sources, mounting, ...) and named
// columns of numbers. The name of a column ends in its unit (`probe_a_um`), and the numbers stay in
// that unit; the evaluation converts them. Both file forms (CSV for people, HDF5 for large
// recordings) have the same content; see docs/recordings.md.
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

// Bits of the column `flags`; 0 is a valid row.
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
  std::string header;  // TOML text, without the leading "# " of the CSV form, one key per line
  std::vector<Column> columns;
  std::vector<std::string>
      warnings;               // e.g. "the file ends in the middle of row 812: that row is dropped"
  std::size_t first_row = 0;  // of a block of a longer recording: its first row in the file

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }

  // The values of a column, or an empty optional.
  std::optional<std::span<const double>> Find(std::string_view column) const;
  // The values of a column; InputError naming the file and the column when it is missing.
  std::span<const double> At(std::string_view column) const;

  // A text of the header by dotted path ("kind", "mounting.head"), or an empty optional. Other TOML
  // values are returned as TOML writes them.
  std::optional<std::string> HeaderText(std::string_view path) const;
  // Numbers of the header, or an empty optional. InputError naming the file and the key when the
  // value is not a number, is below `at_least`, or there are not `count` of them.
  std::optional<double> HeaderNumber(
      std::string_view path, double at_least = -std::numeric_limits<double>::infinity()) const;
  std::optional<std::vector<double>> HeaderNumbers(std::string_view path, std::size_t count) const;
  std::string Kind() const;  // HeaderText("kind"); InputError when missing
  // Whether time_s holds times, not only the order of the rows (header time = "order").
  bool KnowsTimes() const;
  // Whether a device or the virtual rig said that no machine was measured.
  bool IsSimulated() const;
};

}  // namespace abbe::recording
