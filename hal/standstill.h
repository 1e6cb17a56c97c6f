// Readings of a source while the axes stand, when somebody says that they do.
//
//   const auto standstill = AwaitStandstill(source, clock, {.rate = 200.0, .seconds = 1.5,
//                                                           .confirmed = pressed, .shown = show});
//
// The source is read all the time, so that gaps and positions can be watched while the axis is
// moved; only what comes after `confirmed` is kept.
//
// Shapes: for each channel as many values as times.
// Units: values in the unit of the channel's name; s of the clock. Failure: none of its own; a
// sample that is not good is NaN, with its cause.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hal/clock.h"
#include "hal/sample_source.h"

namespace abbe::hal {

enum class Confirmation { kNotYet, kStands, kEnd };

struct StandstillOptions {
  double rate = 200.0;                               // Hz of the clock
  double seconds = 1.5;                              // of the clock, of readings to keep
  std::function<Confirmation()> confirmed = {};      // asked after each reading
  std::function<void(const SampleSet&)> shown = {};  // each reading
};

struct Standstill {
  std::vector<double> times;                // s
  std::vector<std::vector<double>> values;  // for each channel
  std::vector<std::size_t> good;            // readings of each channel
  std::vector<Cause> cause;                 // of its last bad reading; kNone: all good

  std::size_t readings() const { return times.size(); }
};

// Nothing when `confirmed` says kEnd, or the source has ended.
std::optional<Standstill> AwaitStandstill(SampleSource& source, Clock& clock,
                                          const StandstillOptions& options);

}  // namespace abbe::hal
