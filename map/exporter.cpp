#include "map/exporter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>

#include "failure/failure.h"
#include "failure/located.h"
#include "map/export_axis_comp.h"
#include "map/export_grid.h"
#include "map/export_linuxcnc_hal.h"
#include "map/export_tables.h"
#include "map/map_file.h"
#include "map/text_file.h"

namespace abbe::map {
namespace {

constexpr std::string_view kGridDrops =
    "the 21 error functions and what determined each, other tool vectors, the correlation of "
    "errors at different points, the error between the points";
constexpr std::string_view kTableDrops =
    "the uncertainty, what determined each error, the form of the functions between the stations";

}  // namespace

const std::vector<Format>& Formats() {
  static const std::vector<Format> formats = {
      {"csv", ".csv", kGridDrops, WriteCsvGrid, ReadBackCsvGrid, nullptr},
      {"json", ".json", kGridDrops, WriteJsonGrid, ReadBackJsonGrid, nullptr},
      {"hdf5", ".h5", kGridDrops, WriteHdf5Grid, ReadBackHdf5Grid, nullptr},
      {"vtk", ".vtr", kGridDrops, WriteVtkGrid, ReadBackVtkGrid, nullptr},
      {"isg", ".isg.csv", kTableDrops, WriteIsg, ReadBackIsg, ReadIsg},
      {"etalon", ".etalon", kTableDrops, WriteEtalon, ReadBackEtalon, ReadEtalon},
      {"linuxcnc", ".comp",
       "straightness, angles, squareness and the uncertainty: it carries the position error of "
       "each axis along one line through the middle of the travels, no backlash",
       WriteLinuxcnc, ReadBackLinuxcnc, nullptr},
      {"linuxcnc-hal", ".hal",
       "the uncertainty, what determined each error, the error between the points; it carries any "
       "tool",
       WriteLinuxcncHal, ReadBackLinuxcncHal, nullptr},
      {"sinumerik", ".ini",
       "all that depends on two axes at once (the angles times their arms) and the uncertainty: it "
       "carries the three components along three lines through the middle of the travels",
       WriteSinumerik, ReadBackSinumerik, nullptr},
  };
  return formats;
}

const Format& FormatNamed(std::string_view name) {
  std::vector<std::string_view> known;
  for (const Format& format : Formats()) {
    if (format.name == name) return format;
    known.push_back(format.name);
  }
  throw InputError(
      fmt::format("\"{}\" is not a format of a map; write {}", name, fmt::join(known, ", ")));
}

Export ExportMap(const ErrorMap& map, const Format& format, const ExportOptions& options,
                 const std::filesystem::path& path) {
  Export done;
  done.files = format.write(map, options, path);
  done.discrepancy = Compare(map, options.tool, format.read(done.files, map.model().chain()));
  return done;
}

ErrorMap ReadAnyMap(const std::filesystem::path& path, std::string_view chain,
                    std::string_view positive) {
  if (path.extension() == ".toml") return ReadMap(path);
  const std::string text = ReadWhole(path);
  const bool is_etalon =
      text.find("Gridpoints") != std::string::npos || text.find("VALUE") != std::string::npos;
  AxisTables tables = FormatNamed(is_etalon ? "etalon" : "isg").import(path);
  if (!chain.empty()) tables.header.chain = chain;
  if (!positive.empty()) tables.header.positive = positive;
  if (tables.header.machine.empty()) tables.header.machine = path.stem().string();
  return Located(path.string(), [&] { return MapOfTables(tables); });
}

}  // namespace abbe::map
