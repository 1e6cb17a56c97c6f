#include "hal/sample_source.h"

#include <algorithm>
#include <limits>

namespace abbe::hal {

void FinishSet(SampleSet& set, double now_s) {
  double earliest = std::numeric_limits<double>::infinity(), latest = -earliest;
  for (Sample& sample : set.samples) {
    sample.age_s = now_s - sample.time_s;
    if (sample.quality == Quality::kBad) continue;
    earliest = std::min(earliest, sample.time_s - sample.within_s);
    latest = std::max(latest, sample.time_s + sample.within_s);
  }
  const bool any = earliest <= latest;
  set.time_s = any ? 0.5 * (earliest + latest) : now_s;
  set.skew_s = any ? latest - earliest : 0.0;
}

}  // namespace abbe::hal
