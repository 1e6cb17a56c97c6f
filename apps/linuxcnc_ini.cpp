#include "apps/linuxcnc_ini.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <string_view>

#include "failure/failure.h"
#include "map/text_file.h"
#include "settings/ini_text.h"

namespace abbe::apps {
namespace {

// mm in the unit of the control. LinuxCNC compares the words without case.
double MillimetresOf(const std::string& units, const std::string& file) {
  constexpr double kMmPerInch = 25.4;
  std::string word = units;
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  if (word == "mm" || word == "metric") return 1.0;
  if (word == "inch" || word == "in" || word == "imperial") return kMmPerInch;
  if (word.empty()) {
    throw InputError(fmt::format(
        "{}: [TRAJ] LINEAR_UNITS is missing; add LINEAR_UNITS = mm or inch, the unit of the limits",
        file));
  }
  throw InputError(fmt::format(
      "{}: [TRAJ] LINEAR_UNITS = {} is no unit of LinuxCNC; write mm or inch", file, units));
}

}  // namespace

void ReadLinuxcncIni(const std::filesystem::path& path, MachineDescription& machine) {
  const auto values = settings::ParseIni(map::ReadWhole(path), path.string());
  const auto text = [&](const std::string& key) -> std::string {
    const auto found = values.find(key);
    return found == values.end() ? "" : found->second;
  };
  const std::string kinematics = text("KINS.KINEMATICS");
  if (!kinematics.empty() && !kinematics.starts_with("trivkins")) {
    throw InputError(
        fmt::format("{}: KINEMATICS = {}: the axes of abbe move in X, Y and Z; describe "
                    "such a machine by hand (docs/machine-file.md)",
                    path.string(), kinematics));
  }
  const double unit = MillimetresOf(text("TRAJ.LINEAR_UNITS"), path.string());
  if (!text("EMC.MACHINE").empty()) {
    machine.name = text("EMC.MACHINE");
    for (char& c : machine.name) {
      const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-';
      if (!is_plain) c = '-';
    }
  }
  for (AxisDescription& axis : machine.axes) {
    const auto number = [&](const char* key) {
      const std::string where = fmt::format("AXIS_{}.{}", axis.letter, key);
      const std::string value = text(where);
      double result = 0.0;
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), result);
      if (error != std::errc() || end != value.data() + value.size()) {
        throw InputError(
            fmt::format("{}: [AXIS_{}] {} = \"{}\" is not a number; is the axis there?",
                        path.string(), axis.letter, key, value));
      }
      return unit * result;
    };
    axis.travel_mm = {number("MIN_LIMIT"), number("MAX_LIMIT")};
    if (!(axis.travel_mm.first < axis.travel_mm.second)) {
      throw InputError(
          fmt::format("{}: [AXIS_{}] goes from {:g} to {:g} mm; correct MIN_LIMIT or "
                      "MAX_LIMIT",
                      path.string(), axis.letter, axis.travel_mm.first, axis.travel_mm.second));
    }
    axis.limit_mm = axis.travel_mm;
  }
}

}  // namespace abbe::apps
