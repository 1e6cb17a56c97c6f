// Under which conditions a recording was made: temperatures, duration, feed.
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
  std::string started;  // as the header says it
  double duration = 0;  // s
  double feed = 0;      // m/s, the largest commanded one
  std::vector<Temperature> temperatures;
  bool simulated = false;  // no machine was measured: the header says so
};

// Rows with a flag do not count. Any recording with the column time_s.
SweepConditions ConditionsOf(const recording::Recording& recording);

}  // namespace abbe::probes
