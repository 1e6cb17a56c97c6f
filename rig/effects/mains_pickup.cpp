// A line in time in one probe, at the frequency of the mains, which wanders.
#include <array>
#include <cmath>

#include "rig/effects/registry.h"
#include "rig/run_parts.h"

namespace abbe::rig::effects {
namespace {

// By how much the mains is ahead of an even clock, rad: three slow waves, some 10 mHz each at most.
double AheadAt(const HiddenEffect& effect, double time) {
  constexpr std::uint64_t kFirstDraw = 1000;
  constexpr std::array kPeriods{37.0, 110.0, 410.0};  // s
  double ahead = effect.random.Uniform(kFirstDraw, 0.0, kTurn);
  for (std::size_t i = 0; i < kPeriods.size(); ++i) {
    const double slow = kTurn / kPeriods[i];
    const double off = kTurn * effect.random.Uniform(kFirstDraw + 1 + 2 * i, 0.0, 10e-3);
    ahead += off / slow *
             std::sin(slow * time + effect.random.Uniform(kFirstDraw + 2 + 2 * i, 0.0, kTurn));
  }
  return ahead;
}

}  // namespace

Effect MainsPickup() {
  return {
      .name = "mains-pickup",
      .objects = kProbeObject,
      .keys = {{"frequency_hz", Draw::kEither, 50.0, 60.0},
               {"amplitude_um", Draw::kEven, 0.03, 0.5}},
      .in_run =
          [](const HiddenEffect& e, RunParts& run) {
            run.Gap(e.place(), [e, turns = kTurn * e.At("frequency_hz"),
                                amplitude = e.At("amplitude_um")](const MachineState& state) {
              return amplitude * std::sin(turns * state.time + AheadAt(e, state.time));
            });
          },
  };
}

}  // namespace abbe::rig::effects
