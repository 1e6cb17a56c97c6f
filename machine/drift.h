// How a machine may change between measurements, as [drift] of its file states it.
//
//   const Drift drift = ReadDrift(document.Root());
//   drift.walk->straightness;              // m: standard deviation of EYX after a day
//   drift.sensors[0].by_kelvin.scale;      // of its growth with a sensor, relative, for each kelvin
//
// Frames: those of error_motion.h.
// Units: SI. Shapes: sizes as those of Population. A walk is one after a day; after n days it is
// sqrt(n) times as large.
// Failure: InputError with file, line and key.
// Source: own; random walk and first-order lag.
// Validity: slow changes; a collision is none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "machine/machine.h"

namespace abbe::machine {

// The response of the errors to one sensor: standard deviations for each kelvin.
struct SensorDrift {
  std::string sensor;         // "table": the column temp_table_c
  std::optional<double> lag;  // s; none: not stated
  Population by_kelvin;       // over the travel: scale is the growth, the others are bends
};

struct Drift {
  std::optional<Population> walk;  // none: not stated
  std::vector<SensorDrift> sensors;
};

// Reads the sizes of a table with keys like [population], but for the smoothness. `fallback`: of an
// absent one, in the units of the keys: um, urad, ppm.
Population ReadSizes(const settings::Table& table, const Population& fallback);

// Requests all keys of the table, none but these.
Drift ReadDrift(const settings::Table& root);

}  // namespace abbe::machine
