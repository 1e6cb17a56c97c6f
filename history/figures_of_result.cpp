#include "history/figures_of_result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

#include "history/result_reader.h"

namespace abbe::history {
namespace {

struct Reader {
  std::string_view command, kind;  // an empty kind: all of the command
  void (*read)(const Json&, Extract&);
};

constexpr std::array<Reader, 9> kReaders{{{"reduce", "sweep", ReadSweep},
                                          {"reduce", "squareness", ReadSquareness},
                                          {"reduce", "reference", ReadPositioning},
                                          {"circle", "", ReadCircle},
                                          {"path", "", ReadPath},
                                          {"fuse", "", ReadMap},
                                          {"plate", "", ReadMap},
                                          {"calibrate", "", ReadCalibration},
                                          {"diagnose", "", ReadDiagnosis}}};

}  // namespace

void AddStations(const std::string& content, Extract& extract) {
  const auto stations = StationsOf(Json::parse(content, nullptr, /*allow_exceptions=*/false));
  for (Figure& each : extract.figures) each.stations = stations;
}

Extract FiguresOf(const Json& result) {
  Extract extract;
  const std::string command = TextAt(result, "command"), kind = TextAt(result, "kind");
  const auto reader = std::ranges::find_if(kReaders, [&](const Reader& each) {
    return each.command == command && (each.kind.empty() || each.kind == kind);
  });
  if (reader == kReaders.end()) return extract;
  try {
    reader->read(result, extract);
  } catch (const std::exception& error) {
    extract = {};
    extract.trouble = std::string("a key has another form than in docs/report.md (") +
                      error.what() + "); its figures are left out";
  }
  std::erase_if(extract.figures, [](const Figure& each) { return !std::isfinite(each.value); });
  return extract;
}

}  // namespace abbe::history
