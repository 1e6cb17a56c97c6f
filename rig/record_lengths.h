// Recordings of calibrated lengths on the rig, as by an interferometer or a step gauge along a line
// of the machine.
//
//   const recording::Recording line = RecordLengths(rig, {.axis = 'X', .step = 5e-3, .count = 12});
//
// The axes stand at `count` + 1 places, from the first end of the travel of `axis` on, the others
// at `at`. length_mm is the true distance of the tool from the first place, with a relative error
// common to all lengths and white noise of u. The axis comes to each place from below, a second
// after the place before; `both_ways` then turns beyond the last one and comes back to all but the
// first, from above (approach_x ...). Columns and header: docs/recordings.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "rig/record_course.h"

namespace abbe::rig {

struct LengthProgram {
  char axis = 'X';
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m, positions of the other axes
  double step = 5e-3;                            // m
  int count = 12;
  bool both_ways = false;
  double u = 0.1e-6;      // m: noise of one length
  double u_scale = 2e-6;  // relative: standard deviation of the common error
  std::uint64_t run = 1;
  std::string started = "1970-01-01T00:00:00Z";
  std::vector<std::string> sensors = {};  // temperature columns
  double begin = 0.0;                     // s since the machine was switched on
  Climate* climate = nullptr;             // of a campaign; none: its own, and `begin` is 0
};

recording::Recording RecordLengths(const LinkageRig& rig, const LengthProgram& program);

}  // namespace abbe::rig
