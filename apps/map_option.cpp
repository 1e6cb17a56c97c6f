#include "apps/map_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "failure/failure.h"
#include "map/exporter.h"

namespace abbe::apps {

void MapOption::AddTo(CLI::App& command) {
  command.add_option("map", path, "The error map: map.toml of abbe fuse, an ISG or an Etalon file")
      ->required();
  command.add_option("--chain", chain, "For an imported map without its chain: \"[w X Y b Z t]\"");
  command.add_option(
      "--positive", positive,
      "For an imported map without the sign of its axes: tool (ISO 841) or carriage, one "
      "word for all or one each for X, Y and Z");
  command
      .add_option("--tool", tool_mm,
                  "Tool point from the reference point, x,y,z in mm (the map's own)")
      ->delimiter(',')
      ->expected(3);
}

map::ErrorMap MapOption::Read() const {
  map::ErrorMap map = map::ReadAnyMap(path, chain, positive);
  if (!map.origin().scale_is_calibrated) {
    fmt::print(
        stderr,
        "abbe: {}: scale: prior only; no calibrated length went into this map, so lengths in "
        "all directions at once may be wrong\n",
        path.string());
  }
  return map;
}

Eigen::Vector3d MapOption::Tool(const map::ErrorMap& map) const {
  return tool_mm.empty() ? map.origin().tool : VectorOf("--tool", tool_mm);
}

std::array<Eigen::Index, 3> PointsOf(const std::vector<int>& given, bool is_grid) {
  constexpr double kMost = 1e7;  // about 1 GB as text
  if (given.size() != 1 && given.size() != 3) {
    throw InputError("--points takes one number or three, of X, Y and Z");
  }
  const std::array<Eigen::Index, 3> points{given[0], given[given.size() / 2], given.back()};
  double product = 1.0, sum = 0.0;
  for (const Eigen::Index each : points) {
    if (each < 2) {
      throw InputError(fmt::format("--points {}: an axis needs at least 2 points", each));
    }
    product *= each;
    sum += each;
  }
  const double written = is_grid ? product : sum;
  if (written <= kMost) return points;
  throw InputError(fmt::format(
      "--points: {:.3g} points in all, at most {:.0g} are written; take fewer", written, kMost));
}

Eigen::Vector3d VectorOf(const std::string& option, const std::vector<double>& mm) {
  for (const double each : mm) {
    if (std::isfinite(each)) continue;
    throw InputError(
        fmt::format("{} {}: give three numbers in mm, x,y,z", option, fmt::join(mm, ",")));
  }
  return 1e-3 * Eigen::Vector3d(mm.at(0), mm.at(1), mm.at(2));
}

}  // namespace abbe::apps
