#include "hal/standstill.h"

#include <limits>

#include "hal/pace.h"

namespace abbe::hal {
namespace {

void Keep(const SampleSet& set, Standstill& kept) {
  if (!kept.times.empty() && !(set.time_s > kept.times.back())) return;
  kept.times.push_back(set.time_s);
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    const Sample& sample = set.samples[i];
    kept.values[i].push_back(sample.good() ? sample.value
                                           : std::numeric_limits<double>::quiet_NaN());
    if (sample.good()) {
      ++kept.good[i];
    } else {
      kept.cause[i] = sample.cause;
    }
  }
}

}  // namespace

std::optional<Standstill> AwaitStandstill(SampleSource& source, Clock& clock,
                                          const StandstillOptions& options) {
  const std::size_t channels = source.channels().size();
  Standstill kept{{},
                  std::vector<std::vector<double>>(channels),
                  std::vector<std::size_t>(channels, 0),
                  std::vector<Cause>(channels, Cause::kNone)};
  Pace pace(clock, options.rate);
  std::optional<double> end_s;
  while (!source.Ended()) {
    pace.Await();
    const SampleSet set = source.Read();
    pace.Done();
    if (options.shown) options.shown(set);
    const Confirmation said = options.confirmed();
    if (said == Confirmation::kEnd) return {};
    if (end_s) Keep(set, kept);
    if (end_s && set.time_s >= *end_s) return kept;
    if (!end_s && said == Confirmation::kStands) end_s = clock.Now() + options.seconds;
  }
  return {};
}

}  // namespace abbe::hal
