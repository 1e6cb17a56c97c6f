// When and how warm it was while recordings were made: their start and their columns temp_NAME_c.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "map/map_state.h"
#include "simulation/run_source.h"
#include "track/tracked_map.h"

namespace abbe::apps {

// s since 1970; 0: it does not say.
double BeganAt(const recording::Recording& head);
// InputError naming the recording where it does not say when it was made.
double MustHaveBegan(const recording::Recording& head);

// The latest start, and the mean of each sensor over all recordings that have it.
track::Conditions MeanConditions(const std::vector<simulation::RunSource>& sources);

// Row after row, a second apart or more, of the sensors named; readings that are missing are left
// out. A sensor without a column reads what is `given` for it. InputError where a clock jumps back,
// or nothing is.
std::vector<track::Conditions> ConditionsIn(const recording::Recording& recording,
                                            const std::vector<map::Warmth>& sensors,
                                            const std::map<std::string, double>& given);

// "table" for temp_table_c; empty for another column.
std::string SensorOf(const std::string& column);

}  // namespace abbe::apps
