// The formats that a map can be written in. To add one: a file export_NAME.cpp (hdf5_*.cpp for what
// uses HDF5) with a writer and a reader, and one line in exporter.cpp.
//
//   const Export done = ExportMap(map, FormatNamed("isg"), {}, "out/mill.csv");
//   done.discrepancy.largest;    // how far what the file says lies from the map, m
//
// The discrepancy is found by reading the files just written, with the format's own reader, and
// comparing what they say with the map over the whole travels (Compare, map_grid.h): it is what a
// control that reads the file cannot correct.
// Units: SI inside; each format has its own, given in docs/map.md.
// Failure: InputError for an unknown format, points that the format does not take, and files that
// are broken, with their line.
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
  std::string_view drops;  // what it cannot carry, in words
  // Returns the files written, at `path` or beside it.
  Paths (*write)(const ErrorMap& map, const ExportOptions& options,
                 const std::filesystem::path& path);
  // The error in W that the files say, for the tool they were written for.
  ErrorField (*read)(const Paths& files, const machine::Chain& chain);
  // The whole map, for the formats that carry one; else null.
  AxisTables (*import)(const std::filesystem::path& file);
};

const std::vector<Format>& Formats();
const Format& FormatNamed(std::string_view name);

struct Export {
  Format::Paths files;
  Discrepancy discrepancy;
};

Export ExportMap(const ErrorMap& map, const Format& format, const ExportOptions& options,
                 const std::filesystem::path& path);

// A map in our own form (map.toml) or in one that can be imported, told apart by content. `chain`
// and `positive` (Chain::ReadPositive) are for files that do not say theirs, else empty.
ErrorMap ReadAnyMap(const std::filesystem::path& path, std::string_view chain = {},
                    std::string_view positive = {});

}  // namespace abbe::map
