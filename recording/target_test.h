// A positioning test of one linear axis, target by target in cycles, as a recording of kind
// "reference".
//
//   TargetTest test{"b02.dat", "X"};
//   test.targets = {{1, -20.0}, {2, 0.0}};
//   test.forward[{1, 1}] = -20.05;                 // position 1 in cycle 1
//   RecordingOf(std::move(test));
//
// Positions are counted from 1 in the order of forward motion; backwards the axis visits them in
// reverse order. Forwards is direction +1 when the targets ascend and -1 when they descend.
//
// The recording has the columns time_s, x_mm (the target), pass (the cycle), direction, ref_x_mm
// and flags; with axis Y they are y_mm and ref_y_mm, and so on. Such tests have no times: time_s is
// the order of measurement, 1 per reading, and the header has time = "order". A reading that is
// missing (an interrupted test) is missing in the recording, with a warning.
// Units: targets and readings in `mm_per_unit`. Failure: InputError with the file for an axis other
// than X, Y, Z, for targets that neither ascend nor descend, and for more cycles than any test has.
// Source: ISO 230-2. For the importers of this folder.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "recording/recording.h"

namespace abbe::recording {

struct TargetPlace {
  int position, cycle;  // from 1
  bool operator<(const TargetPlace& other) const {
    return std::tie(position, cycle) < std::tie(other.position, other.cycle);
  }
};

struct TargetTest {
  std::string file, axis;
  std::map<int, double> targets = {};  // of the positions 1, 2, ...
  std::map<TargetPlace, double> forward = {}, backward = {};
  int cycles = 0;
  double mm_per_unit = 1.0;
  std::string more_header = {};  // lines behind those that every test has
  // What the file calls targets and readings, for messages.
  std::string_view target_name = "target", forward_name = "forwards", backward_name = "backwards";
  std::vector<std::string> warnings = {};
};

// InputError unless `axis` is X, Y or Z.
void MustBeLinear(const std::string& file, const std::string& axis);

// One row for each target that was reached, in the order of measurement.
Recording RecordingOf(TargetTest test);

}  // namespace abbe::recording
