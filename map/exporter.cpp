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
#include "map/file_header.h"
#include "map/map_file.h"
#include "map/text_file.h"

namespace abbe::map {
namespace {

constexpr std::string_view kGridDrops =
    "the 21 error functions and what determined each, other tool vectors, the correlation of "
    "errors at different points, the error between the points";
constexpr std::string_view kTableDrops =
    "the uncertainty, what determined each error, the form of the functions between the stations";

[[noreturn]] void RefuseContradiction(std::string_view option, std::string_view given,
                                      std::string_view stated) {
  throw InputError(fmt::format("states {} = \"{}\", but --{} says \"{}\"; leave the option out",
                               option, stated, option, given));
}

// What the command line says stands where the file says nothing, and must not contradict it.
void Complete(FileHeader& header, std::string_view chain, std::string_view positive) {
  if (!chain.empty()) {
    const std::string given = machine::Chain::Parse(chain).Text();
    if (!header.chain.empty() && machine::Chain::Parse(header.chain).Text() != given) {
      RefuseContradiction("chain", given, header.chain);
    }
    header.chain = given;
  }
  if (positive.empty()) return;
  FileHeader given = header;
  given.positive = positive;
  if (!header.positive.empty() && !header.chain.empty()) {
    const std::string stated = ChainOf(header).PositiveText();
    if (ChainOf(given).PositiveText() != stated) {
      RefuseContradiction("positive", positive, stated);
    }
  }
  header = given;
}

}  // namespace

const std::vector<Format>& Formats() {
  static const std::vector<Format> formats = {
      {"csv", ".csv", kGridDrops, WriteCsvGrid, ReadBackCsvGrid, nullptr},
      {"json", ".json", kGridDrops, WriteJsonGrid, ReadBackJsonGrid, nullptr},
      {"hdf5", ".h5", kGridDrops, WriteHdf5Grid, ReadBackHdf5Grid, nullptr},
      {"vtk", ".vtr", kGridDrops, WriteVtkGrid, ReadBackVtkGrid, nullptr},
      {"isg", ".isg.csv", kTableDrops, WriteIsg, ReadBackIsg, ReadIsg, false},
      {"etalon", ".etalon", kTableDrops, WriteEtalon, ReadBackEtalon, ReadEtalon, false},
      {"linuxcnc", ".comp",
       "straightness, angles, squareness and the uncertainty: it carries the position error of "
       "each axis along one line through the middle of the travels, no backlash",
       WriteLinuxcnc, ReadBackLinuxcnc, nullptr, false},
      {"linuxcnc-hal", ".hal",
       "the uncertainty, what determined each error, the error between the points; it carries any "
       "tool",
       WriteLinuxcncHal, ReadBackLinuxcncHal, nullptr},
      {"sinumerik", ".ini",
       "all that depends on two axes at once (the angles times their arms) and the uncertainty: it "
       "carries the three components along three lines through the middle of the travels",
       WriteSinumerik, ReadBackSinumerik, nullptr, false},
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
  if (path.extension() == ".toml") {
    ErrorMap map = ReadMap(path);
    FileHeader header = HeaderOf(map, map.origin().tool);
    Located(path.string(), [&] { Complete(header, chain, positive); });
    return map;
  }
  const std::string text = ReadWhole(path);
  const bool is_etalon =
      text.find("Gridpoints") != std::string::npos || text.find("VALUE") != std::string::npos;
  AxisTables tables = FormatNamed(is_etalon ? "etalon" : "isg").import(path);
  Located(path.string(), [&] { Complete(tables.header, chain, positive); });
  if (tables.header.machine.empty()) tables.header.machine = path.stem().string();
  return Located(path.string(), [&] { return MapOfTables(tables); });
}

}  // namespace abbe::map
