// What a control knows while it runs an NC program: modes, offsets, tools, where the axes are.
//
// Two sets of offsets: `wanted` is the program's own, at the places that it means; `control` is
// that of the control, which runs the corrected program. They differ where the program takes the
// place of the axes for an offset (G92, G10 L20): the control takes the corrected place.
// Frames: NcState::place in program coordinates by `wanted`. Units: m; `feed` as written.
// Shapes: positions X, Y, Z. Failure: none. Validity: modes of RS 274/NGC.
// Source: RS 274/NGC (NIST IR 6556); LinuxCNC 2.9 for the parameters of NcLive.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compensation/nc_beside.h"
#include "compensation/nc_offsets.h"
#include "compensation/nc_parameters.h"
#include "compensation/nc_tables.h"

namespace abbe::compensation {

inline constexpr int kNoMotion = -1;

// Modal groups whose words M70, M72 and M73 keep and restore.
enum class NcGroup {
  kUnits,
  kPlane,
  kDistance,
  kCentre,
  kDiameter,
  kFeedMode,
  kSpindleMode,
  kRetract,
  kSystem,
  kToolLength,
  kPath,
  kFeed,
  kSpeed,
  kSpindle,
  kMist,
  kFlood
};
using NcModalWords = std::map<NcGroup, std::string>;

struct NcState {
  int motion = kNoMotion;  // ten times its code
  int plane = 17;
  bool is_inch = false, is_relative = false, centre_is_absolute = false, is_diameter = false;
  bool retracts_to_r = true;  // as LinuxCNC starts
  NcModalWords words;         // as written
  NcOffsets wanted, control;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  std::array<bool, 3> is_known{};
  // A, B, C in program coordinates, degrees; kRuntime where not known.
  std::array<double, 3> rotary{kRuntime, kRuntime, kRuntime};
  // Values that a cycle keeps from block to block, as written.
  double cycle_r = kRuntime, cycle_bottom = kRuntime, cycle_peck = kRuntime, cycle_dwell = kRuntime;
  double cycle_initial = kRuntime;  // where the first cycle of a row began, along the normal
  double feed = 0.0, speed = 0.0;
  std::optional<int> tool, selected;  // numbers
  double tool_diameter = 0.0;
  NcBesideSetting beside{0.0, 0.0};  // G41, G42; side 0: G40
  // Where the tool's centre stands after G40, until the next move: beside `place`.
  std::optional<Eigen::Vector3d> stands;

  // G41 or G42 with a tool that has a radius.
  bool IsBeside() const { return beside.side != 0.0 && beside.radius > 0.0; }
  double Unit() const;  // of lengths in the program, m
  // G93.
  bool HasInverseFeed() const;
  // All three axes.
  bool KnowsPlace() const { return is_known[0] && is_known[1] && is_known[2]; }
  // Changes an offset; the axes stay.
  template <typename Change>
  void ChangeOffsets(Change change) {
    const NcOffsets before = wanted;
    change(wanted);
    change(control);
    place = wanted.ToProgram(before.ToMachine(place));
    if (stands) stands = wanted.ToProgram(before.ToMachine(*stands));
    rotary.fill(kRuntime);
  }
};

// Reads the parameters of the control from `state`, which must live as long.
NcLive LiveOf(const NcState& state, const NcTables& tables);

// The blocks that restore `before` from `now`.
std::vector<std::string> Restoring(const NcModalWords& before, const NcModalWords& now);

}  // namespace abbe::compensation
