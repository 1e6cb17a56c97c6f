#include "compensation/nc_state.h"

#include <cmath>
#include <numbers>

#include "settings/unit.h"

namespace abbe::compensation {
namespace {

constexpr double kInchInMetres = 25.4 * settings::kMillimetre;
constexpr double kDegreeInRadians = std::numbers::pi / 180.0;

// #5161-5166 and #5181-5186: G28 and G30; #5210-5219: G92; #5220: the system; #5221-5390: the
// systems; lengths in the unit of the machine's files.
std::optional<double> Stored(const NcState& state, const NcTables& tables, int number) {
  const NcOffsets& offsets = state.wanted;
  constexpr int kHomes[2] = {5161, 5181};
  for (int home = 0; home < 2; ++home) {
    const int axis = number - kHomes[home];
    if (axis >= 0 && axis < 3) {
      if (!offsets.home_is_known[home]) return std::nullopt;
      return offsets.homes[home][axis] / tables.unit;
    }
  }
  if (number == 5210) return offsets.g92_acts ? 1.0 : 0.0;
  if (number >= 5211 && number <= 5213) return offsets.g92[number - 5211] / tables.unit;
  if (number == 5220) return offsets.active + 1.0;
  constexpr int kFirst = 5221, kStep = 20, kRotation = 9;
  const int system = (number - kFirst) / kStep, item = (number - kFirst) % kStep;
  if (number < kFirst || system >= kSystems || !offsets.is_known[system]) return std::nullopt;
  if (item < 3) return offsets.systems[system][item] / tables.unit;
  if (item == kRotation) return offsets.rotations[system] / kDegreeInRadians;
  return std::nullopt;
}

std::optional<double> Coordinate(const NcState& state, int axis) {
  if (!state.is_known[axis] || state.IsBeside() || state.stands) return std::nullopt;
  return state.place[axis] / state.Unit();
}

std::optional<double> LiveNumber(const NcState& state, const NcTables& tables, int number) {
  if (number >= 5161 && number <= 5390) return Stored(state, tables, number);
  if (number == 5400 && state.tool) return *state.tool;
  if (number >= 5401 && number <= 5403) return state.wanted.tool[number - 5401] / tables.unit;
  if (number >= 5404 && number <= 5409) return 0.0;
  if (number == 5410 && state.tool && tables.tools) return state.tool_diameter;
  if (number >= 5420 && number <= 5422) return Coordinate(state, number - 5420);
  return std::nullopt;
}

bool Has(const NcState& state, NcGroup group, std::string_view word) {
  const auto found = state.words.find(group);
  return found != state.words.end() && found->second.starts_with(word);
}

// "_ini[section]key": LinuxCNC looks for both in upper case.
std::optional<double> OfIni(const std::map<std::string, double>& ini, const std::string& name) {
  std::string key = name.substr(std::string_view("_ini[").size());
  for (char& c : key) {
    if (c == ']') c = '.';
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  const auto found = ini.find(key);
  if (found == ini.end()) return std::nullopt;
  return found->second;
}

std::optional<double> LiveName(const NcState& state, const NcTables& tables,
                               const std::string& name) {
  if (name.starts_with("_ini[") && tables.ini) return OfIni(*tables.ini, name);
  // Values of the control at the time.
  if (name.starts_with("_hal[") || name.starts_with("_ini[")) return kRuntime;
  if (name == "_metric") return !state.is_inch;
  if (name == "_imperial") return state.is_inch;
  if (name == "_absolute") return !state.is_relative;
  if (name == "_incremental") return state.is_relative;
  if (name == "_ijk_absolute_mode") return state.centre_is_absolute;
  if (name == "_lathe_diameter_mode") return state.is_diameter;
  if (name == "_lathe_radius_mode") return !state.is_diameter;
  if (name == "_retract_r_plane") return state.retracts_to_r;
  if (name == "_retract_old_z") return !state.retracts_to_r;
  if (name == "_plane") return 10.0 * state.plane;
  if (name == "_motion_mode") return state.motion == kNoMotion ? 800.0 : state.motion;
  if (name == "_coord_system") {
    constexpr int kLastWhole = 6;
    const int active = state.wanted.active;
    return active < kLastWhole ? 540.0 + 10.0 * active : 590.0 + (active - kLastWhole + 1);
  }
  if (name == "_tool_offset") return Has(state, NcGroup::kToolLength, "G43");
  if (name == "_inverse_time") return Has(state, NcGroup::kFeedMode, "G93");
  if (name == "_units_per_rev") return Has(state, NcGroup::kFeedMode, "G95");
  if (name == "_units_per_minute") {
    return !Has(state, NcGroup::kFeedMode, "G93") && !Has(state, NcGroup::kFeedMode, "G95");
  }
  if (name == "_spindle_css_mode") return Has(state, NcGroup::kSpindleMode, "G96");
  if (name == "_spindle_rpm_mode") return !Has(state, NcGroup::kSpindleMode, "G96");
  if (name == "_spindle_on") {
    return Has(state, NcGroup::kSpindle, "M3") || Has(state, NcGroup::kSpindle, "M4");
  }
  if (name == "_spindle_cw") return Has(state, NcGroup::kSpindle, "M3");
  if (name == "_mist") return Has(state, NcGroup::kMist, "M7");
  if (name == "_flood") return Has(state, NcGroup::kFlood, "M8");
  if (name == "_ccomp") {
    constexpr double kNone = 400.0, kLeft = 410.0, kRight = 420.0;
    return state.beside.side == 0.0 ? kNone : state.beside.side > 0.0 ? kLeft : kRight;
  }
  if (name == "_feed") return state.feed;
  if (name == "_rpm") return state.speed;
  if (name == "_task") return 1.0;  // a control runs the program
  if (name == "_x" || name == "_y" || name == "_z") {
    return Coordinate(state, name[1] - 'x').value_or(kRuntime);
  }
  if (name == "_abs_x" || name == "_abs_y" || name == "_abs_z") {
    const int axis = name.back() - 'x';
    if (!state.KnowsPlace() || state.IsBeside() || state.stands) return kRuntime;
    return state.wanted.ToMachine(state.place)[axis] / state.Unit();
  }
  if (name == "_current_tool") return state.tool ? *state.tool : kRuntime;
  if (name == "_selected_tool") return state.selected ? *state.selected : kRuntime;
  for (const std::string_view known : {"_vmajor",
                                       "_vminor",
                                       "_line",
                                       "_current_pocket",
                                       "_selected_pocket",
                                       "_speed_override",
                                       "_feed_override",
                                       "_adaptive_feed",
                                       "_feed_hold",
                                       "_a",
                                       "_b",
                                       "_c",
                                       "_u",
                                       "_v",
                                       "_w",
                                       "_abs_a",
                                       "_abs_b",
                                       "_abs_c",
                                       "_abs_u",
                                       "_abs_v",
                                       "_abs_w"}) {
    if (name == known) return kRuntime;
  }
  return std::nullopt;
}

// The word of a group before a program sets it: the modes that LinuxCNC starts in.
std::string_view Default(NcGroup group) {
  switch (group) {
    case NcGroup::kUnits:
      return "G21";
    case NcGroup::kPlane:
      return "G17";
    case NcGroup::kDistance:
      return "G90";
    case NcGroup::kCentre:
      return "G91.1";
    case NcGroup::kDiameter:
      return "G8";
    case NcGroup::kFeedMode:
      return "G94";
    case NcGroup::kSpindleMode:
      return "G97";
    case NcGroup::kRetract:
      return "G99";
    case NcGroup::kSystem:
      return "G54";
    case NcGroup::kToolLength:
      return "G49";
    case NcGroup::kPath:
      return "G64";
    case NcGroup::kSpindle:
      return "M5";
    case NcGroup::kMist:
    case NcGroup::kFlood:
      return "M9";
    default:
      return "";  // a feed and a speed that were never set
  }
}

}  // namespace

bool NcState::HasInverseFeed() const { return Has(*this, NcGroup::kFeedMode, "G93"); }

double NcState::Unit() const { return is_inch ? kInchInMetres : settings::kMillimetre; }

NcLive LiveOf(const NcState& state, const NcTables& tables) {
  return {[&](int number) { return LiveNumber(state, tables, number); },
          [&](const std::string& name) { return LiveName(state, tables, name); }};
}

std::vector<std::string> Restoring(const NcModalWords& before, const NcModalWords& now) {
  std::vector<std::string> lines(1);
  bool stops_coolant = false;
  const auto wanted = [&](NcGroup group) -> std::string_view {
    const auto found = before.find(group);
    return found == before.end() ? Default(group) : std::string_view(found->second);
  };
  for (const auto& [group, word] : now) {
    if (wanted(group) == word || wanted(group).empty()) continue;
    if (group == NcGroup::kMist || group == NcGroup::kFlood) {
      stops_coolant = true;
      continue;
    }
    if (!lines[0].empty()) lines[0] += ' ';
    lines[0] += wanted(group);
  }
  if (lines[0].empty()) lines.clear();
  if (!stops_coolant) return lines;
  lines.emplace_back("M9");  // both, then again what ran
  for (const NcGroup group : {NcGroup::kMist, NcGroup::kFlood}) {
    if (wanted(group) != "M9") lines.emplace_back(wanted(group));
  }
  return lines;
}

}  // namespace abbe::compensation
