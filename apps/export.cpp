// abbe export: an error map in the formats of other programs, and what each format cannot
// represent.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/map_option.h"
#include "apps/result_file.h"
#include "map/exporter.h"
#include "map/map_grid.h"

namespace abbe::apps {
namespace {

struct ExportCommand {
  MapOption map;
  std::string format;
  std::filesystem::path out;
  std::filesystem::path json;
  std::vector<int> points = {31};
  bool quiet = false;
};

nlohmann::ordered_json ResultOf(const ExportCommand& options, const map::ErrorMap& map,
                                const map::Export& done) {
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const auto& file : done.files) files.push_back(file.string());
  return {{"abbe", ABBE_VERSION},
          {"command", "export"},
          {"machine", map.origin().machine},
          {"chain", map.model().chain().Text()},
          {"map", options.map.path.filename()},
          {"format", options.format},
          {"files", files},
          {"drops", map::FormatNamed(options.format).drops},
          {"largest_difference_um", done.discrepancy.largest * 1e6},
          {"rms_difference_um", done.discrepancy.rms * 1e6},
          {"largest_error_um", done.discrepancy.error * 1e6}};
}

void Print(const map::Format& format, const map::Export& done) {
  const map::Discrepancy& d = done.discrepancy;
  const Eigen::Vector3d where = d.where * 1e3;
  for (const auto& file : done.files) fmt::print("{}\n", file.string());
  fmt::print("{} drops: {}\n", format.name, format.drops);
  fmt::print(
      "read back, it differs from the map by up to {:.3g} um (at X {:.4g} Y {:.4g} Z {:.4g} mm), "
      "rms {:.3g} um; the map's largest error is {:.3g} um\n",
      d.largest * 1e6, where.x(), where.y(), where.z(), d.rms * 1e6, d.error * 1e6);
}

int RunExport(const ExportCommand& options) {
  const map::Format& format = map::FormatNamed(options.format);
  const map::ErrorMap map = options.map.Read();
  for (const char axis : {'X', 'Y', 'Z'}) {
    if (map.model().chain().Text().find(axis) != std::string::npos) continue;
    throw InputError(
        fmt::format("{}: the machine has no axis {}; the formats need a volume of X, Y "
                    "and Z",
                    options.map.path.string(), axis));
  }
  std::filesystem::path out = options.out;
  if (out.empty()) {
    out = options.map.path;
    out.replace_extension(format.extension);
    if (out == options.map.path) out.replace_extension("again" + std::string(format.extension));
  }
  const map::ExportOptions at{PointsOf(options.points, format.is_grid), options.map.Tool(map)};
  std::array<Eigen::Index, 3> looked_at = at.counts;
  constexpr Eigen::Index kOfLines = 31;  // a coarse grid around lines along the axes
  for (Eigen::Index& each : looked_at) each = format.is_grid ? each : std::min(each, kOfLines);
  if (!map::SampleErrors(map, at.tool, looked_at).error().allFinite()) {
    throw InputError(fmt::format(
        "{}: gives no finite error in its volume; it may be damaged: export or fuse it again",
        options.map.path.string()));
  }
  const map::Export done = map::ExportMap(map, format, at, out);
  if (!options.quiet) Print(format, done);
  if (!options.json.empty()) WriteResult(ResultOf(options, map, done), options.json);
  return kDone;
}

}  // namespace

void AddExport(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<ExportCommand>();
  CLI::App* command = program.add_subcommand(
      "export", "Writes an error map in the format of a control or of another program");
  options->map.AddTo(*command);
  std::vector<std::string> formats;
  for (const map::Format& format : map::Formats()) formats.emplace_back(format.name);
  command->add_option("--format", options->format, "Of which control or program")
      ->required()
      ->check(CLI::IsMember(formats));
  command->add_option("--out", options->out, "The file to write (beside the map)");
  command->add_option("--points", options->points, "Points along an axis, or along X,Y,Z (31)")
      ->delimiter(',');
  command->add_option("--json", options->json, "What was written and dropped, as data");
  command->add_flag("--quiet", options->quiet, "Print nothing but warnings");
  command->footer("Example: abbe export out/map.toml --format isg --points 61");
  command->callback([options, &exit_code] { exit_code = RunExport(*options); });
}

}  // namespace abbe::apps
