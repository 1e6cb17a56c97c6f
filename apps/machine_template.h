// The text of a new machine file, with comments that say what to check and measure.
//
//   MachineDescription mill = DescriptionOf("mill");
//   mill.axes[0].travel_mm = {0.0, 500.0};
//   MachineText(mill);
//
// Kinds: mill (moving table), gantry, lathe, axis, arm, shaft. Units: mm, as in the file.
// Failure: InputError for another kind, a travel whose end is not above its beginning.
// Source: docs/machine-file.md. Validity: numbers of instruments are those of the demonstration
// machine and have to be replaced by one's own, as the comments say.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe::apps {

struct AxisDescription {
  char letter;
  std::pair<double, double> travel_mm{0.0, 500.0};
  std::optional<std::pair<double, double>> limit_mm;
  bool carries_work = false;
};

struct MachineDescription {
  std::string kind, name = "my-machine";
  std::string chain;  // empty: no axes
  std::vector<AxisDescription> axes;
  std::string positive = "tool";  // of axes that carry the workpiece
  bool has_head = false;          // the five-probe head, its sweeps and devices
};

inline constexpr std::array<std::string_view, 6> kMachineKinds{"mill", "gantry", "lathe",
                                                               "axis", "arm",    "shaft"};

MachineDescription DescriptionOf(std::string_view kind);
std::string MachineText(const MachineDescription& machine);

}  // namespace abbe::apps
