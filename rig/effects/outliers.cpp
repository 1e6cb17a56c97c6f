// One outlier at the first value at or after each instant, of random sign, from a least size to ten
// times that.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {
namespace {

std::function<double(double, double)> Outlying(const HiddenEffect& effect, double least) {
  constexpr std::uint64_t kSizes = 2000;  // index of draws
  return [random = effect.random, instants = effect.instants, next = std::size_t{0}, least,
          begun = false](double time, double value) mutable {
    // Instants before the first value belong to another recording.
    while (!begun && next < instants.size() && instants[next] < time) ++next;
    begun = true;
    if (next >= instants.size() || !(instants[next] <= time)) return value;
    const std::uint64_t index = kSizes + next++;
    const double size = least * (1.0 + 9.0 * random.Uniform(index));
    return random.Bits(index)[3] % 2 == 0 ? value + size : value - size;
  };
}

}  // namespace

Effect Outliers() {
  return {
      .name = "outliers",
      .objects = kChannelObjects,
      .keys = {{"count", Draw::kWhole, 3.0, 30.0}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            constexpr double kLeastGap = 1e-6, kLeastAngle = 100e-6;  // m, rad
            const bool probe = IsOfProbe(e);
            run.Said(probe, e.place(), Outlying(e, probe ? kLeastGap : kLeastAngle));
          },
      .instants = "count",
  };
}

}  // namespace abbe::rig::effects
