// The screws that set up target and head, as the table [align] of the machine file describes them.
//
//   [align.screw.front]
//   clockwise = "z"                  # the target rises there when the screw is turned clockwise
//   pitch_mm = 0.25                  # in one turn; 0: a support without a screw
//   position_mm = [30, -40, -30]     # of its tip, from the corner of the target
//
// Frames: M, the machine; the corner of the target is the origin of the head frame H when the sweep
// starts, so a place holds for the sweeps of all axes. Units: m a turn, m.
// Failure: InputError with file, line and key. docs/machine-file.md lists every key.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::probes {

enum class ScrewedBody { kTarget, kHead };

struct Screw {
  std::string name;
  ScrewedBody body;
  Eigen::Vector3d direction;  // in M: of the body at the screw, which is turned clockwise
  Eigen::Vector3d place;      // m, in M, from the corner of the target
  double pitch;               // m a turn; 0: a support that cannot be turned
};

struct AlignSettings {
  double margin;  // m: to stay free at both ends of the range of each probe
  double motion;  // m: standard deviation of what the error motions of the axis do to a gap
  std::vector<Screw> screws;
};

AlignSettings ReadAlignSettings(const settings::Table& root);

}  // namespace abbe::probes
