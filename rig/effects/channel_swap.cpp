// The columns of two probes exchanged, noise and all.
#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {

Effect ChannelSwap() {
  return {
      .name = "channel-swap",
      .objects = kProbePairObject,
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.swapped.push_back(
                {static_cast<std::size_t>(e.places[0]), static_cast<std::size_t>(e.places[1])});
          },
  };
}

}  // namespace abbe::rig::effects
