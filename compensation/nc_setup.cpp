#include "compensation/nc_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compensation/nc_cycles.h"

namespace abbe::compensation {

using Eigen::Vector3d;

void NcSetup::TakeModes(const NcBlock& block, const NcMeaning& meaning, std::size_t line_number) {
  line_number_ = line_number;
  if (state_.IsBeside() || state_.stands) MustStayBeside(meaning);
  TakeTool(block, meaning);
  for (const int code : meaning.modes) TakeMode(code, meaning);
  KeepModalWords(block, line_number, state_);
  if (meaning.motion == kNoMotion) return;
  if (!IsCycle(meaning.motion) || !IsCycle(state_.motion)) {
    state_.cycle_r = state_.cycle_initial = kRuntime;
  }
  if (meaning.motion != state_.motion) {
    state_.cycle_bottom = state_.cycle_peck = state_.cycle_dwell = kRuntime;
  }
  constexpr int kCancel = 800;
  state_.motion = meaning.motion == kCancel ? kNoMotion : meaning.motion;
}

void NcSetup::TakeMode(int code, const NcMeaning& meaning) {
  switch (code) {
    case 170:
    case 180:
    case 190:
      state_.plane = code / 10;
      return;
    case 200:
    case 210:
      state_.is_inch = code == 200;
      return;
    case 900:
    case 910:
      state_.is_relative = code == 910;
      return;
    case 901:
    case 911:
      state_.centre_is_absolute = code == 901;
      return;
    case 70:
    case 80:
      state_.is_diameter = code == 70;
      return;
    case 980:
    case 990:
      state_.retracts_to_r = code == 990;
      return;
    case 430:
    case 431:
    case 432:
    case 490:
      return TakeToolLength(code, meaning);
    case 400:
    case 410:
    case 411:
    case 420:
    case 421:
      return TakeBeside(code, meaning);
    default:
      break;
  }
  constexpr int kG54 = 540, kG59 = 590;
  if (code >= kG54 && code <= kG59 + 3) {
    const int system = code <= kG59 ? (code - kG54) / 10 : code - kG59 + 5;
    if (!state_.wanted.is_known[system]) {
      Refuse(
          fmt::format("the offset of G{:g} is known only at the control; name its parameter "
                      "file with --parameters",
                      code / 10.0));
    }
    state_.ChangeOffsets([&](NcOffsets& offsets) { offsets.active = system; });
  }
}

const NcTool& NcSetup::ToolOf(double number) {
  if (!options_.tables.tools) {
    Refuse("length and radius of a tool are in the tool table; name it with --tools tool.tbl");
  }
  const auto& tools = *options_.tables.tools;
  const auto found = std::find_if(tools.begin(), tools.end(),
                                  [&](const auto& tool) { return tool.first == number; });
  if (found == tools.end()) {
    Refuse(fmt::format("tool {:.9g} is not in the tool table; add it", number));
  }
  return found->second;
}

void NcSetup::TakeTool(const NcBlock& block, const NcMeaning& meaning) {
  for (const NcWord& word : block.words) {
    // M6 and M66 make the control look where the axes are.
    const int code = word.letter == 'M' ? CodeTimes10(word) : kNoMotion;
    if (state_.stands && (code == 60 || code == 660)) {
      state_.place = *state_.stands;
      state_.stands.reset();
    }
    constexpr double kLargestTool = 1e6;
    const bool is_tool = word.value >= 0.0 && word.value < kLargestTool;
    if (word.letter == 'T') {
      state_.selected.reset();
      if (is_tool) state_.selected = static_cast<int>(word.value);
    }
    if (code == 610) {
      state_.tool.reset();
      if (meaning.q && *meaning.q >= 0.0 && *meaning.q < kLargestTool) {
        state_.tool = static_cast<int>(*meaning.q);
      }
    }
  }
  if (meaning.changes_tool) state_.tool = state_.selected;
  if (!state_.tool || !options_.tables.tools) return;
  const auto found = options_.tables.tools->find(*state_.tool);
  state_.tool_diameter = found == options_.tables.tools->end() ? 0.0 : found->second.diameter;
}

void NcSetup::TakeToolLength(int code, const NcMeaning& meaning) {
  const Vector3d before = state_.wanted.tool;
  Vector3d tool = Vector3d::Zero();
  if (code == 430 || code == 432) {
    if (code == 432) tool = before;
    double number = meaning.h.value_or(0.0);
    if (code == 432 && !meaning.h) Refuse("G43.2 without H");
    if (!meaning.h && !state_.tool) {
      Refuse("G43 without H, and no tool was changed before it (M6); write G43 with H");
    }
    if (!meaning.h) number = *state_.tool;
    if (number != 0.0) tool += options_.tables.unit * ToolOf(number).offset;
  } else if (code == 431) {
    tool = before;
    for (int k = 0; k < 3; ++k) {
      if (!meaning.axes[k]) continue;
      tool[k] = state_.Unit() * *meaning.axes[k] / (k == 0 && state_.is_diameter ? 2.0 : 1.0);
    }
  }
  if (tool != Vector3d::Zero() && !options_.p_TQ_gauge) {
    Refuse(fmt::format(
        "a tool offset of X {:.6g} Y {:.6g} Z {:.6g} mm moves the point at which the errors of "
        "the map act; give with --tool the point of a tool whose length offset is 0",
        1e3 * tool.x(), 1e3 * tool.y(), 1e3 * tool.z()));
  }
  state_.ChangeOffsets([&](NcOffsets& offsets) { offsets.tool = tool; });
  if (options_.p_TQ_gauge) {
    corrector_.SetTool(*options_.p_TQ_gauge - corrector_.signs().cwiseProduct(tool));
  }
}

// The radius is of the tool D, of the tool in the spindle without D, of the diameter D in G41.1.
void NcSetup::TakeBeside(int code, const NcMeaning& meaning) {
  constexpr int kEnd = 400, kLeft = 410, kLeftByDiameter = 411;
  if (code == kEnd) return;
  if (state_.beside.side != 0.0) Refuse("G41 or G42 while one is in force; write G40 before it");
  if (state_.plane == 19) Refuse("G41 and G42 belong to the planes G17 and G18");
  if (state_.HasInverseFeed()) Refuse("G41 and G42 in G93; write feeds in G94");
  if (!state_.KnowsPlace()) {
    Refuse("G41 or G42 while the position of the machine is unknown; begin with G0 to X, Y and Z");
  }
  const bool is_left = code == kLeft || code == kLeftByDiameter;
  double diameter = 0.0;
  if (code % 10 == 1) {
    if (!meaning.d) Refuse("G41.1 and G42.1 take D, the diameter of the tool");
    diameter = state_.Unit() * *meaning.d;
  } else {
    double number = meaning.d.value_or(0.0);
    if (number == 0.0 && !state_.tool) {
      Refuse("G41 or G42 without D, and no tool was changed before it (M6); write D with a tool");
    }
    if (number == 0.0) number = *state_.tool;
    if (number != 0.0) {
      const NcTool& tool = ToolOf(number);
      constexpr int kRound = 9;
      if (tool.orientation != 0 && tool.orientation != kRound) {
        Refuse(
            fmt::format("tool {:g} has an orientation (Q{}); let the CAM system write the path "
                        "of its point",
                        number, tool.orientation));
      }
      diameter = options_.tables.unit * tool.diameter;
    }
  }
  state_.beside = {is_left == (diameter >= 0.0) ? 1.0 : -1.0, std::abs(diameter) / 2.0,
                   state_.plane, state_.is_inch ? 1e-3 : 25.4e-3};
}

bool NcSetup::Changes(int code) const {
  switch (code) {
    case 170:
    case 180:
    case 190:
      return state_.plane != code / 10;
    case 200:
    case 210:
      return state_.is_inch != (code == 200);
    case 900:
    case 910:
      return state_.is_relative != (code == 910);
    case 901:
    case 911:
      return state_.centre_is_absolute != (code == 901);
    case 400:
    case 940:
    case 960:
    case 970:
      return false;
    default:
      return true;
  }
}

void NcSetup::MustStayBeside(const NcMeaning& meaning) const {
  constexpr int kDwell = 40, kCancel = 800;
  const bool is_nonmodal =
      meaning.nonmodal != kNoMotion && (meaning.nonmodal != kDwell || meaning.HasAxes());
  if (!state_.IsBeside()) {  // after G40
    if (is_nonmodal || meaning.is_beside || IsCycle(meaning.motion)) {
      Refuse("the tool still stands beside the path that G40 ended; let G0 or G1 lead away first");
    }
    return;
  }
  const bool changes = std::any_of(meaning.modes.begin(), meaning.modes.end(),
                                   [this](int code) { return Changes(code); });
  if (changes || is_nonmodal || meaning.is_g53 || meaning.changes_tool || meaning.HasRotary() ||
      meaning.motion == kCancel || IsCycle(meaning.motion)) {
    Refuse(
        "between G41 or G42 and G40 only lines and arcs are supported, and modes, offsets and the "
        "tool stay; write G40 before it");
  }
}

Vector3d NcSetup::Given(const NcMeaning& meaning) const {
  Vector3d given;
  for (int k = 0; k < 3; ++k) {
    given[k] = kRuntime;
    if (!meaning.axes[k]) continue;
    given[k] = state_.Unit() * *meaning.axes[k] / (k == 0 && state_.is_diameter ? 2.0 : 1.0);
  }
  return given;
}

void NcSetup::MustKnow(const NcMeaning& meaning) const {
  for (int k = 0; k < 3; ++k) {
    const bool needs = meaning.axes[k] || state_.wanted.IsTurned();
    if (needs && !state_.is_known[k]) {
      Refuse(
          fmt::format("an offset from the place in {}, which is not known; begin with G0 to X, "
                      "Y and Z in G90, or give the start with --start x,y,z",
                      "XYZ"[k]));
    }
  }
}

void NcSetup::TakeG92(int code, const NcMeaning& meaning) {
  const Vector3d given = Given(meaning);
  const Vector3d machine = state_.wanted.ToMachine(state_.place);
  constexpr int kSet = 920, kForget = 921, kSuspend = 922;
  if (code == kSet) {
    MustKnow(meaning);
    state_.wanted.SetG92(machine, given);
    state_.control.SetG92(writer_.at(), given);
  } else {
    for (NcOffsets* offsets : {&state_.wanted, &state_.control}) {
      if (code == kForget) offsets->g92.setZero();
      offsets->g92_acts = code > kSuspend;
    }
  }
  state_.place = state_.wanted.ToProgram(machine);
  if (code != kSet) state_.rotary.fill(kRuntime);
  TakeAngles(meaning, true);
}

// An axis that is not given stays where it is in program coordinates.
void NcSetup::TakeAngles(const NcMeaning& meaning, bool is_here) {
  for (int k = 0; k < 3; ++k) {
    if (meaning.rotary[k]) state_.rotary[k] = is_here ? *meaning.rotary[k] : kRuntime;
  }
}

void NcSetup::TakeG10(const NcMeaning& meaning) {
  if (meaning.l && *meaning.l != 2.0 && *meaning.l != 20.0) {
    Refuse(
        "G10 L0, L1, L10 and L11 change the tool table of the control; set it there and name "
        "it with --tools");
  }
  if (!meaning.l || !meaning.p) Refuse("G10 takes L and P");
  const double p = *meaning.p;
  if (!(p >= 0.0 && p <= kSystems) || p != std::round(p)) {
    Refuse(fmt::format("G10 P{:.9g}: coordinate systems are P1 to P9, P0 the active one", p));
  }
  const int system = p == 0.0 ? state_.wanted.active : static_cast<int>(p) - 1;
  const Vector3d given = Given(meaning);
  const Vector3d machine = state_.wanted.ToMachine(state_.place);
  const bool is_here = *meaning.l == 20.0;
  if (is_here) MustKnow(meaning);
  const bool is_whole = meaning.axes[0] && meaning.axes[1] && meaning.axes[2];
  for (NcOffsets* offsets : {&state_.wanted, &state_.control}) {
    if (meaning.radius) offsets->rotations[system] = *meaning.radius * std::numbers::pi / 180.0;
    if (is_here) {
      if (meaning.radius) Refuse("G10 L20 with R; set the turn with G10 L2");
      offsets->SetSystem(system, offsets == &state_.wanted ? machine : writer_.at(), given);
    } else {
      for (int k = 0; k < 3; ++k) {
        if (meaning.axes[k]) offsets->systems[system][k] = given[k];
      }
    }
    offsets->is_known[system] = offsets->is_known[system] || is_whole;
  }
  if (state_.wanted.IsTurned() && !state_.KnowsPlace()) state_.is_known.fill(false);
  state_.place = state_.wanted.ToProgram(machine);
  if (system == state_.wanted.active) TakeAngles(meaning, is_here);
}

void NcSetup::TakeHome(int home) {
  if (!state_.KnowsPlace()) {
    Refuse("G28.1 or G30.1 at a place that is not known; begin with G0 to X, Y and Z");
  }
  state_.wanted.homes[home] = state_.wanted.ToMachine(state_.place);
  state_.wanted.home_is_known[home] = true;
}

void NcSetup::TakeOffsets(const NcMeaning& meaning, std::size_t line_number) {
  line_number_ = line_number;
  switch (meaning.nonmodal) {
    case 281:
    case 301:
      return TakeHome(meaning.nonmodal == 281 ? 0 : 1);
    case 100:
      return TakeG10(meaning);
    case 920:
    case 921:
    case 922:
    case 923:
      return TakeG92(meaning.nonmodal, meaning);
    default:
      return;
  }
}

}  // namespace abbe::compensation
