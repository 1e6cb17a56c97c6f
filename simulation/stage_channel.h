// A channel: one stage of the simulation (disturbance.h) by the name of what errs there.
//
//   const std::vector<StageChannel> channels = ChannelsOf(scene);
//   const std::optional<StageChannel> one = ChannelNamed("EYX");
//
// Names: "probe_a" and "sensor_1" (what a probe, or a sensor at a shaft, reads beside its gap),
// "pivot_1" (what its encoder shows beside its angle), "X" (the positioning of an axis), "EAX" and
// so on (its other error motions), "ball_x" (the place of the ball in the linkage).
// Units: amounts in m or rad, printed in `unit`.
// Failure: none; a name of no channel is empty.
// Source: own names; machine/error_motion.h for those of error motions.
// Validity: as disturbance.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "simulation/causes/cause.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// The instruments that runs are recorded with.
enum Instrument : unsigned { kFeltByProbes = 1, kFeltByLinkage = 2, kFeltAtRim = 4 };
Instrument InstrumentOf(const Trace& trace);

struct StageChannel {
  std::string object;  // "probe_a", "pivot_1", "X", "EAX"
  Eigen::Index stage;
  estimation::PrintUnit unit;
  unsigned instruments;  // whose runs feel it

  bool Feels(const Trace& trace) const { return (instruments & InstrumentOf(trace)) != 0; }
  // Whether so much could be left at all.
  bool IsPlausible(double amount) const;
};
// Those that the runs of a scene could tell of.
std::vector<StageChannel> ChannelsOf(const Scene& scene);
std::optional<StageChannel> ChannelNamed(const std::string& name);

}  // namespace abbe::simulation
