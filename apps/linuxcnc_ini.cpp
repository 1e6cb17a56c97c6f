#include "apps/linuxcnc_ini.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <map>
#include <string>
#include <string_view>

#include "failure/failure.h"
#include "map/text_file.h"

namespace abbe::apps {
namespace {

// "SECTION.KEY" -> value; the first of several.
using IniValues = std::map<std::string, std::string>;

std::string_view TrimmedIni(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

IniValues ReadIni(const std::filesystem::path& path) {
  const std::string text = map::ReadWhole(path);
  IniValues values;
  std::string section;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = TrimmedIni(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    if (line[0] == '[') {
      section = line.substr(1, line.find(']') - 1);
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
      if (line[0] == '.') continue;  // "#INCLUDE" and continued lines of other programs
      throw InputError(
          fmt::format("{}:{}: neither [SECTION] nor KEY = VALUE; is it an INI file of "
                      "LinuxCNC?",
                      path.string(), number));
    }
    std::string_view value = line.substr(equals + 1);
    value = TrimmedIni(value.substr(0, value.find(" #")));
    values.try_emplace(section + "." + std::string(TrimmedIni(line.substr(0, equals))), value);
  }
  return values;
}

}  // namespace

void ReadLinuxcncIni(const std::filesystem::path& path, MachineDescription& machine) {
  const IniValues values = ReadIni(path);
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
  const std::string units = text("TRAJ.LINEAR_UNITS");
  constexpr double kMmPerInch = 25.4;
  const double unit = units == "inch" || units == "in" || units == "imperial" ? kMmPerInch : 1.0;
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
    axis.limit_mm = axis.travel_mm;
  }
}

}  // namespace abbe::apps
