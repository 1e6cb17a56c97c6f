// The conditions of a recording: temperatures, duration, feed.
// Units: degC, s, m/s.
// Failure: InputError for a recording without time_s, or with `started` that is no instant.
// Validity: largest and smallest of single rows, so one wild row shows in them.
#pragma once

#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::probes {

struct Spread {
  double min, max, mean;
};

struct SweepConditions {
  struct Temperature {
    std::string name;  // of the column: "temp_column_c"
    Spread spread;     // degC
  };
  std::string started;  // of the header, in UTC
  double duration = 0;  // s
  double feed = 0;      // m/s, the largest commanded one
  std::vector<Temperature> temperatures;
  bool simulated = false;  // the header states that no machine was measured
};

// Over the rows without a flag of any recording with the column time_s.
SweepConditions ConditionsOf(const recording::Recording& recording);

}  // namespace abbe::probes
