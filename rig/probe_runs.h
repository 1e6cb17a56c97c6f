// Recordings of the probe head other than sweeps, made in memory: gap steps and a dwell.
//
//   const recording::Recording steps = RecordGapSteps(world, 'X', options);
//
// Gap steps: the head stands as for the sweep of `axis`, the swept axis at a few of its stations;
// at each, one after the other, the two other axes step through 0, +45, 0, -45, 0 um about their
// start and stand at each step, and their rows are recorded. All axes come to the start from below;
// direction is the sign of the last step.
//
// Dwell: the machine stands at the start of the sweep of the axis, samples 0.093 s apart (no
// multiple of the period of the mains); with a linkage its encoders too, on the same rows.
//
// Columns: time_s x_mm y_mm z_mm pass direction feed_mm_min, the five gaps, the three angles, the
// temperatures, flags. Noise and hidden effects as in campaign.h. InputError for an axis without a
// programmed sweep.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "rig/climate.h"
#include "rig/record_course.h"
#include "rig/world.h"

namespace abbe::rig {

struct ProbeRunOptions {
  double rate = 200.0;   // rows in a second, of gap steps
  double stand = 0.5;    // s at each gap step
  int places = 3;        // of the swept axis, for gap steps
  double length = 60.0;  // s, of a dwell
  std::uint64_t run = 1;
  std::string started = "1970-01-01T00:00:00Z";
  std::string keys = {}, tables = {};  // further lines of TOML, in front of the tables, behind
  std::vector<std::string> sensors = {};
  double begin = 0.0;          // s since the machine was switched on
  Climate* climate = nullptr;  // of a campaign; none: its own, and `begin` is 0
};

inline constexpr double kGapStep = 45e-6;        // m
inline constexpr double kDwellInterval = 0.093;  // s

Course GapStepCourse(const RigSettings& settings, char axis, const ProbeRunOptions& options);

recording::Recording RecordGapSteps(const World& world, char axis, const ProbeRunOptions& options);

// `linkage` may be absent; else it is of the same world.
recording::Recording RecordDwell(const World& world, char axis, const LinkageRig* linkage,
                                 const ProbeRunOptions& options);

}  // namespace abbe::rig
