#include "apps/machine_template.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "hal/transports.h"
#include "settings/toml_text.h"

namespace abbe::apps {
namespace {

constexpr std::string_view kPopulation = R"(
# The errors of such machines: standard deviations over many of them. They are the priors of every fit;
# a machine tool of medium size and good state:
[population]
positioning_um = 5.0
straightness_um = 3.0
roll_urad = 20.0
pitch_urad = 20.0
yaw_urad = 20.0
squareness_urad = 50.0
scale_ppm = 20.0
smoothness_mm = {:g}           # over how much travel the errors change
)";

constexpr std::string_view kHead = R"(
# The five-probe head: places of the probes on the head frame (docs/machine-file.md, "The head"). Measure yours.
[head]
[head.probe_a]
unit = "top"
position_mm = [10.0, 0.0]
range_um = 200.0
[head.probe_b]
unit = "top"
position_mm = [0.0, 10.0]
range_um = 200.0
[head.probe_c]
unit = "top"
position_mm = [0.0, -10.0]
range_um = 200.0
[head.probe_d]
unit = "side"
position_mm = [0.0, 20.0]
range_um = 200.0
[head.probe_e]
unit = "side"
position_mm = [10.0, 20.0]
range_um = 200.0

# What remains unknown after manufacture and mounting: standard deviations.
[head.tolerance]
probe_position_um = 10.0
installation_urad = 500.0
installation_um = 50.0
gain_ppm = 500.0
linearity_um = 0.12  # 0.1 % of the range: limit of the certificate / 1.7

# The target: its form from its certificate.
[target]
form_nm = 10.0
form_length_mm = 15.0

[noise]
probe_nm = 20.0
drift_nm = 30.0
drift_time_s = 600.0

# How a sweep is driven; first to last within the travel and the length of the target.
[sweep]
passes = 5
dwell_s = 0.5
settle_s = 0.1
window_um = 20.0
feed_mm_min = 600.0
)";

constexpr std::string_view kArm = R"(
# The joints from the base to the tool, by the nominal rows of the maker: d along z, a along x, alpha about x.
[linkage]
form = "denavit-hartenberg"
ball_mm = [0.0, 0.0, 100.0]        # what the instrument sees, from the last joint: to some centimetres
bearing_harmonics = []
graduation_harmonics = []

[[linkage.joint]]
d_mm = 290.0
alpha_deg = -90.0
[[linkage.joint]]
a_mm = 270.0
theta_deg = -90.0
[[linkage.joint]]
a_mm = 70.0
alpha_deg = -90.0
[[linkage.joint]]
d_mm = 302.0
alpha_deg = 90.0
[[linkage.joint]]
alpha_deg = -90.0
[[linkage.joint]]
d_mm = 72.0

[linkage.base]
position_mm = [0.0, 0.0, 0.0]

# Standard deviations of what the maker's rows leave open.
[linkage.tolerance]
link_um = 500.0
ball_um = 20000.0
pivot_urad = 1000.0
encoder_offset_urad = 3000.0

# One reading: of an encoder, of the instrument; and how well the arm repeats.
[linkage.noise]
encoder_urad = 5.0
reference_um = 10.0
repeatability_um = 20.0
)";

std::string Pair(const std::pair<double, double>& pair) {
  return fmt::format("[{:g}, {:g}]", pair.first, pair.second);
}

bool HasKind(std::string_view kind) {
  return std::find(kMachineKinds.begin(), kMachineKinds.end(), kind) != kMachineKinds.end();
}

std::string AxisText(const AxisDescription& axis, const std::string& positive) {
  if (!(axis.travel_mm.first < axis.travel_mm.second)) {
    throw InputError(
        fmt::format("the travel of {} goes from {:g} to {:g} mm; give its lower end first",
                    axis.letter, axis.travel_mm.first, axis.travel_mm.second));
  }
  std::string text = fmt::format("\n[axis.{}]\ntravel_mm = {}", axis.letter, Pair(axis.travel_mm));
  text += "            # as the control shows it: where the errors will be known\n";
  if (axis.limit_mm) {
    text += fmt::format("limit_mm = {}             # the control's soft limits\n",
                        Pair(*axis.limit_mm));
  }
  if (axis.carries_work) {
    text += fmt::format(
        "# Jog to a larger {0}. If the tool goes towards the + end of the workpiece: \"tool\" (ISO 841); if the\n"
        "# table itself goes towards + of the machine: \"carriage\". Data read the other way are wrong.\n"
        "positive = \"{1}\"\n",
        axis.letter, positive);
  }
  return text;
}

// Divides the length, at most 60 stations.
double StepOf(double length) {
  constexpr double kMostSteps = 60.0, kSteps = 50.0;
  for (const double step : {1.0, 2.0, 5.0, 10.0, 20.0, 25.0, 50.0, 100.0}) {
    if (step >= length / kMostSteps && std::fmod(length, step) == 0.0) return step;
  }
  return length / kSteps;
}

std::string HeadText(const MachineDescription& machine) {
  std::string text(kHead);
  for (const AxisDescription& axis : machine.axes) {
    const double step = StepOf(axis.travel_mm.second - axis.travel_mm.first);
    text += fmt::format("[sweep.{}]\nfirst_mm = {:g}\nlast_mm = {:g}\nstep_mm = {:.12g}\n",
                        axis.letter, axis.travel_mm.first, axis.travel_mm.second, step);
  }
  std::string letters;
  for (const AxisDescription& axis : machine.axes) letters += axis.letter;
  return text + hal::ExampleDevices(letters);
}

}  // namespace

MachineDescription DescriptionOf(std::string_view kind) {
  if (!HasKind(kind)) {
    throw InputError(fmt::format(
        "{}: no kind of machine; there are mill, gantry, lathe, axis, arm and shaft", kind));
  }
  MachineDescription machine;
  machine.kind = kind;
  const auto axis = [](char letter, bool carries_work) {
    return AxisDescription{letter, {0.0, 500.0}, {}, carries_work};
  };
  if (kind == "mill") {
    machine.chain = "[w X Y b Z t]";
    machine.axes = {axis('X', true), axis('Y', true), axis('Z', false)};
  } else if (kind == "gantry") {
    machine.chain = "[w b Y X Z t]";
    machine.axes = {axis('X', false), axis('Y', false), axis('Z', false)};
  } else if (kind == "lathe") {
    machine.chain = "[w (C) b Z X t]";
    machine.axes = {axis('X', false), axis('Z', false)};
  } else if (kind == "axis") {
    machine.chain = "[w X b t]";
    machine.axes = {axis('X', true)};
  }
  return machine;
}

std::string MachineText(const MachineDescription& machine) {
  if (machine.has_head && machine.axes.empty()) {
    throw InputError(
        fmt::format("--head belongs to a machine with axes, which {} has not", machine.kind));
  }
  std::string text = fmt::format(
      "# {}: written by abbe init. Every key is described in docs/machine-file.md;\n"
      "# \"abbe init --check FILE\" says what is missing for which command.\n\n"
      "name = {}          # stands in every recording and result\n",
      machine.kind == "axis" ? "one axis" : machine.kind, settings::Quoted(machine.name));
  if (machine.kind == "arm") return text + std::string(kArm);
  if (machine.axes.empty()) {
    return text +
           "\n# A turning shaft needs nothing else: the places of its sensors stand in the recording.\n";
  }
  text += fmt::format(
      "# The axes from the workpiece w over the bed b to the tool t: before b they carry the workpiece.\n"
      "chain = \"{}\"\n"
      "# The point at which the error motions are stated, with all axes at zero.\n"
      "reference_mm = [0.0, 0.0, 0.0]\n",
      machine.chain);
  double longest = 0.0;
  for (const AxisDescription& axis : machine.axes) {
    text += AxisText(axis, machine.positive);
    longest = std::max(longest, axis.travel_mm.second - axis.travel_mm.first);
  }
  constexpr double kSmoothShare = 0.25;
  text += fmt::format(kPopulation, kSmoothShare * longest);
  if (machine.has_head) text += HeadText(machine);
  return text +
         "\n# For certificates: a table [certificate]; docs/certificate.md has one to copy.\n";
}

}  // namespace abbe::apps
