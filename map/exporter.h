// Export of a map to the formats of other programs. To add one: a file export_NAME.cpp (hdf5_*.cpp
// if it uses HDF5) with a writer and a reader, and one line in exporter.cpp.
//
//   const Export done = ExportMap(map, FormatNamed("isg"), {}, "out/mill.csv");
//   done.discrepancy.largest;    // largest difference of the file from the map, m
//
// For the discrepancy the files just written are read with the reader of the format and compared
// with the map over the whole travels (Compare, map_grid.h): it is the part of the error that the
// file cannot represent.
// Frames: the error in W, actual minus nominal (error_map.h).
// Units: SI inside; each format has its own, given in docs/map.md. Shapes: points along X, Y, Z, x
// fastest.
// Failure: InputError for an unknown format, points that the format does not take, and damaged
// files, with the line.
// Source: docs/map.md, format by format.
// Validity: a format holds what it can; the discrepancy says what that leaves out, and `drops` in
// words.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "map/axis_tables.h"
#include "map/error_map.h"
#include "map/map_grid.h"

namespace abbe::map {

struct ExportOptions {
  std::array<Eigen::Index, 3> counts = {31, 31, 31};  // points along X, Y, Z
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();     // p_TQ, m
};

struct Format {
  using Paths = std::vector<std::filesystem::path>;

  std::string_view name;
  std::string_view extension;
  std::string_view drops;  // the content of a map that it cannot represent, in words
  // Returns the files written, at `path` or beside it.
  Paths (*write)(const ErrorMap& map, const ExportOptions& options,
                 const std::filesystem::path& path);
  // The error in W according to the files, for the tool they were written for.
  ErrorField (*read)(const Paths& files, const machine::Chain& chain);
  // The whole map, for formats that contain one; else null.
  AxisTables (*import)(const std::filesystem::path& file);
  bool is_grid = true;  // holds every point of the volume; else lines along the axes
};

// All formats, in the order of `abbe map`'s help.
const std::vector<Format>& Formats();
// InputError for an unknown name, with the known ones.
const Format& FormatNamed(std::string_view name);

struct Export {
  Format::Paths files;
  Discrepancy discrepancy;
};

// Writes the map, reads the files back and compares them with the map.
Export ExportMap(const ErrorMap& map, const Format& format, const ExportOptions& options,
                 const std::filesystem::path& path);

// Reads map.toml (by its extension) or an importable format (by its content). `chain` and
// `positive` (Chain::ReadPositive) are those of a file that does not state them; empty: not given.
// InputError where they contradict the file.
ErrorMap ReadAnyMap(const std::filesystem::path& path, std::string_view chain = {},
                    std::string_view positive = {});

}  // namespace abbe::map
