#include "apps/path_uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <string>

#include "settings/unit.h"
#include "simulation/doubt.h"
#include "standards/coverage.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;

bool IsFigure(const std::string& pointer, const ordered_json& value) {
  static const std::regex kUnit("(.*_um|.*_urad)(/[0-9]+)?");
  return value.is_number() && std::regex_match(pointer, kUnit) &&
         pointer.find("/u_um") == std::string::npos &&
         pointer.find("/distances_um") == std::string::npos;
}

}  // namespace

void AddCalibrationUncertainty(const std::vector<TestResult>& shifted, const LeftUnexplained& left,
                               TestResult& test) {
  if (shifted.empty()) return;
  const ordered_json before = test.data.flatten();
  ordered_json u;
  for (const auto& [pointer, value] : before.items()) {
    if (!IsFigure(pointer, value)) continue;
    double squares = 0.0;
    for (const TestResult& one : shifted) {
      const ordered_json::json_pointer at(pointer);
      if (!one.data.contains(at)) continue;
      const double change = one.data.at(at).get<double>() - value.get<double>();
      squares += change * change;
    }
    const double unexplained =
        pointer.find("_urad") == std::string::npos ? left.displacement : left.angle;
    u[pointer] = simulation::WithDoubt(std::sqrt(squares), 0.0, unexplained / settings::kMicro);
  }
  if (u.empty()) return;
  std::map<std::string, double> most;  // the largest of the entries of a list
  for (const auto& [pointer, value] : u.items()) {
    static const std::regex kIndex("/[0-9]+"), kSlash("/");
    const std::string name =
        std::regex_replace(std::regex_replace(pointer, kIndex, "").substr(1), kSlash, " ");
    most[name] = std::max(most[name], value.get<double>());
  }
  std::string line;
  for (const auto& [name, value] : most) {
    line +=
        fmt::format("{}{} {:.2f}", line.empty() ? "" : ", ", name, standards::kCoverage * value);
  }
  if (!line.empty()) test.table += fmt::format("  U95 from the calibration, at most: {}\n", line);
  test.data["u_calibration"] = u.unflatten();
}

}  // namespace abbe::apps
