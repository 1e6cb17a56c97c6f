#include "rig/rig_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <vector>

namespace abbe::rig {
namespace {

using settings::Table;

constexpr std::array<const char*, kAxes> kAxisNames = {"X", "Y", "Z"};

// Machines that a file may call by name.
const std::map<std::string, std::string, std::less<>> kNamedChains = {
    {"column", "wXYbZt"},
    {"moving-bridge", "wbYXZt"},
    {"gantry", "wbYXZt"},
    {"l-shaped-bridge", "wbYXZt"},
    {"fixed-bridge", "wYbXZt"},
    {"moving-horizontal-arm", "wbXZYt"},
    {"fixed-horizontal-arm", "wXbZYt"},
};

// The letters of "[w X Y b Z t]" without blanks, primes and spindles in parentheses.
std::string ChainLetters(const std::string& text) {
  if (const auto named = kNamedChains.find(text); named != kNamedChains.end()) return named->second;
  std::string letters;
  bool spindle = false;
  for (const char letter : text) {
    if (letter == '(') spindle = true;
    if (letter == ')') {
      spindle = false;
    } else if (!spindle && (std::isalpha(static_cast<unsigned char>(letter)) != 0)) {
      letters += letter;
    }
  }
  return letters;
}

void ReadChain(const Table& root, RigSettings& rig) {
  const std::string letters = ChainLetters(root.Text("chain"));
  const std::size_t bed = letters.find('b');
  std::string axes = letters;
  std::erase_if(axes, [](char letter) { return letter == 'w' || letter == 'b' || letter == 't'; });
  std::sort(axes.begin(), axes.end());
  const bool linear = !axes.empty() && axes.find_first_not_of("XYZ") == std::string::npos &&
                      std::adjacent_find(axes.begin(), axes.end()) == axes.end();
  if (letters.size() != axes.size() + 3 || letters.front() != 'w' || letters.back() != 't' ||
      bed == std::string::npos || !linear) {
    throw root.Error(
        "chain",
        "must hold w, then b and the axes of X, Y, Z that there are in any order, then t: "
        "\"[w X Y b Z t]\", or the name of a configuration");
  }
  rig.workpiece_axes = letters.substr(1, bed - 1);
  rig.tool_axes = letters.substr(bed + 1, letters.size() - bed - 2);
}

double ReadSense(const Table& axis, const RigSettings& rig, int number) {
  const bool carries_workpiece = rig.CarriesTarget(number);
  const std::string positive = axis.Text("positive", "tool");
  const bool said = axis.Has("positive") || !carries_workpiece;
  if (said && positive == "tool") return carries_workpiece ? -1.0 : 1.0;
  if (said && positive == "carriage") return 1.0;
  throw axis.Error(
      "positive",
      "must be \"tool\", where the number rises as the tool goes towards + against the "
      "workpiece (ISO 841), or \"carriage\", where it rises as the carriage does");
}

void ReadMachine(const Table& root, RigSettings& rig) {
  rig.name = root.Text("name");
  ReadChain(root, rig);
  const auto reference = root.Quantities("reference_mm", 3, std::vector{0.0, 0.0, 0.0});
  rig.reference = Eigen::Vector3d(reference[0], reference[1], reference[2]);
  for (int axis = 0; axis < kAxes; ++axis) {
    rig.travels[axis] = {0.0, 0.0};  // without such an axis
    if ((rig.workpiece_axes + rig.tool_axes).find(*kAxisNames[axis]) == std::string::npos) continue;
    const auto ends = root.Child("axis").Child(kAxisNames[axis]).Quantities("travel_mm", 2);
    rig.travels[axis] = {ends[0], ends[1]};
    rig.sense[axis] = ReadSense(root.Child("axis").Child(kAxisNames[axis]), rig, axis);
  }
  const Table table = root.Child("population");
  const auto sd = [&](const char* key, double fallback) {
    return table.Quantity(key, {.fallback = fallback, .at_least = 0.0});
  };
  rig.population = {
      sd("positioning_um", 2.0), sd("straightness_um", 1.0),
      sd("roll_urad", 20.0),     sd("pitch_urad", 20.0),
      sd("yaw_urad", 20.0),      sd("squareness_urad", 30.0),
      sd("scale_ppm", 20.0),     table.Quantity("smoothness_mm", {.fallback = 15.0, .above = 0.0})};
}

HeadPlace ReadHeadPlace(const Table& table, int axis) {
  static const std::array<std::vector<std::string>, kAxes> frames = {
      {{"x", "y", "z"}, {"y", "-x", "z"}, {"z", "y", "-x"}}};
  HeadPlace place;
  const auto names = table.Texts("rotation", 3, frames[axis]);
  for (int i = 0; i < 3; ++i) place.rotation.col(i) = DirectionOf(table, "rotation", names[i]);
  const Eigen::Vector3d u = place.rotation.col(0), s = place.rotation.col(1);
  if (u != Eigen::Vector3d::Unit(axis) || u.cross(s) != place.rotation.col(2)) {
    throw table.Error("rotation", "must be right-handed and begin with the swept axis");
  }
  const auto position = table.Quantities("position_mm", 3, std::vector{0.0, 0.0, 0.0});
  place.position = Eigen::Vector3d(position[0], position[1], position[2]);
  return place;
}

void ReadHead(const Table& head, RigSettings& rig) {
  struct Nominal {
    const char* table;
    const char* unit;
    double along, across;  // mm
  };
  static constexpr std::array<Nominal, kProbes> nominals = {{{"probe_a", "top", 10.0, 0.0},
                                                             {"probe_b", "top", 0.0, 10.0},
                                                             {"probe_c", "top", 0.0, -10.0},
                                                             {"probe_d", "side", 0.0, 20.0},
                                                             {"probe_e", "side", 10.0, 20.0}}};
  for (int probe = 0; probe < kProbes; ++probe) {
    const Nominal& nominal = nominals[probe];
    const Table table = head.Child(nominal.table);
    const auto position =
        table.Quantities("position_mm", 2, std::vector{nominal.along, nominal.across});
    const std::string unit = table.Text("unit", nominal.unit);
    if (unit != "top" && unit != "side") throw table.Error("unit", "must be \"top\" or \"side\"");
    rig.probes[probe] = {unit == "top", position[0], position[1],
                         table.Quantity("range_um", {.fallback = 200.0, .above = 0.0})};
  }
  const Table tolerance = head.Child("tolerance");
  const auto sd = [&](const char* key, double fallback) {
    return tolerance.Quantity(key, {.fallback = fallback, .at_least = 0.0});
  };
  rig.probe_position = sd("probe_position_um", 10.0);
  rig.installation_angle = sd("installation_urad", 500.0);
  rig.installation_offset = sd("installation_um", 50.0);
  rig.gain = sd("gain_ppm", 500.0);
  rig.linearity = sd("linearity_um", 0.0);
  for (int axis = 0; axis < kAxes; ++axis) {
    rig.head[axis] = ReadHeadPlace(head.Child(std::string("axis_") + kAxisNames[axis]), axis);
  }
}

void ReadNoise(const Table& target, const Table& noise, RigSettings& rig) {
  rig.form = target.Quantity("form_nm", {.fallback = 10.0, .at_least = 0.0});
  rig.form_length = target.Quantity("form_length_mm", {.fallback = 15.0, .above = 0.0});
  rig.target_squareness = target.Quantity("squareness_urad", {.fallback = 0.0});
  rig.u_target_squareness =
      target.Quantity("u_squareness_urad", {.fallback = 0.0, .at_least = 0.0});
  rig.white = noise.Quantity("probe_nm", {.fallback = 20.0, .at_least = 0.0});
  rig.drift = noise.Quantity("drift_nm", {.fallback = 30.0, .at_least = 0.0});
  rig.drift_time = noise.Quantity("drift_time_s", {.fallback = 600.0, .above = 0.0});
}

void ReadScrews(const Table& screws, RigSettings& rig) {
  for (const Table& table : screws.Named()) {
    if (table.Text("body", "target") != "target") continue;  // the head of the rig has none
    const auto place = table.Quantities("position_mm", 3);
    rig.screws.push_back({table.key(),
                          DirectionOf(table, "clockwise", table.Text("clockwise", "z")),
                          {place[0], place[1], place[2]},
                          table.Quantity("pitch_mm", {.at_least = 0.0})});
  }
}

void ReadOwn(const Table& own, RigSettings& rig) {
  rig.acceleration = own.Quantity("acceleration_mm_s2", {.fallback = 200.0, .above = 0.0});
  rig.lag = own.Quantity("lag_ms", {.fallback = 15.0, .above = 0.0});
  rig.update_rate = own.Quantity("update_hz", {.fallback = 1000.0, .above = 0.0, .at_most = 1e6});
  rig.target_tilt = own.Quantity("target_tilt_urad", {.fallback = 100.0, .at_least = 0.0});
  rig.gap_setting = own.Quantity("gap_setting_um", {.fallback = 10.0, .at_least = 0.0});
  rig.electrode = own.Quantity("electrode_mm", {.fallback = 0.0, .at_least = 0.0});
  rig.temperature = own.Quantity("temperature_c", {.fallback = 20.0});
  rig.temperature_drift = own.Quantity("temperature_drift_c", {.fallback = 0.1, .at_least = 0.0});
  rig.cap = own.Quantity("cap_um", {.fallback = 1.0, .at_least = 0.0});
  rig.cap_feed = own.Quantity("cap_feed_mm_min", {.fallback = 10.0, .above = 0.0});
  rig.cap_force = own.Quantity("cap_force_n", {.fallback = 8.5, .above = 0.0});
  rig.encoder_counts = own.Quantity("encoder_counts", {.fallback = 4194304.0, .above = 0.0});
  own.RefuseUnknown();
}

ErrorPopulation ReadSizes(const Table& table) {
  const auto size = [&](const char* key) {
    return table.Quantity(key, {.fallback = 0.0, .at_least = 0.0});
  };
  return {size("positioning_um"), size("straightness_um"), size("roll_urad"), size("pitch_urad"),
          size("yaw_urad"),       size("squareness_urad"), size("scale_ppm"), 0.0};
}

AgeingSettings ReadAgeing(const Table& table) {
  const auto number = [&](const char* key) {
    return table.Quantity(key, {.fallback = 0.0, .at_least = 0.0});
  };
  AgeingSettings ageing{ReadSizes(table), ReadSizes(table.Child("by_kelvin")), number("lag_s"),
                        number("swing_c"), number("wander_c")};
  table.Child("by_kelvin").RefuseUnknown();
  table.RefuseUnknown();
  return ageing;
}

}  // namespace

RigSettings ReadRigSettings(const Table& root) {
  RigSettings rig;
  ReadMachine(root, rig);
  ReadHead(root.Child("head"), rig);
  const Table sweep = root.Child("sweep");
  for (int axis = 0; axis < kAxes; ++axis) {
    if (!sweep.Has(kAxisNames[axis])) continue;
    rig.sweeps[axis] = hal::ReadSweepPlan(sweep, static_cast<char>('X' + axis));
  }
  ReadNoise(root.Child("target"), root.Child("noise"), rig);
  ReadScrews(root.Child("align").Child("screw"), rig);
  rig.ageing = ReadAgeing(root.Child("rig").Child("ageing"));
  ReadOwn(root.Child("rig"), rig);
  return rig;
}

Eigen::Vector3d DirectionOf(const Table& table, const char* key, const std::string& text) {
  const bool turned = text.size() == 2 && text.front() == '-';
  const char letter = text.empty() ? ' ' : text.back();
  if (letter < 'x' || letter > 'z' || text.size() != (turned ? 2U : 1U)) {
    throw table.Error(key, fmt::format("\"{}\" is no direction of the machine, like \"-x\"", text));
  }
  return (turned ? -1.0 : 1.0) * Eigen::Vector3d::Unit(letter - 'x');
}

bool RigSettings::CarriesTarget(int axis) const {
  return workpiece_axes.find(static_cast<char>('X' + axis)) != std::string::npos;
}

Eigen::Vector3d RigSettings::StartOf(int axis) const {
  Eigen::Vector3d start(travels[0].first, travels[1].first, travels[2].first);
  if (sweeps[axis]) start[axis] = sweeps[axis]->first();
  return start;
}

Eigen::Vector3d RigSettings::MovedBy(const std::string& axes,
                                     const Eigen::Vector3d& command) const {
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();
  for (const char letter : axes) {
    const int axis = letter - 'X';
    travel[axis] = sense[axis] * command[axis];
  }
  return travel;
}

Eigen::Vector3d RigSettings::TargetTravel(const Eigen::Vector3d& command) const {
  return MovedBy(workpiece_axes, command);
}

Eigen::Vector3d RigSettings::HeadTravel(const Eigen::Vector3d& command) const {
  return MovedBy(tool_axes, command);
}

int AxisNumber(char letter) {
  if (letter < 'X' || letter > 'Z') {
    throw InputError(fmt::format("'{}' is no axis of the rig; name X, Y or Z", letter));
  }
  return letter - 'X';
}

}  // namespace abbe::rig
