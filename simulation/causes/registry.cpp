#include "simulation/causes/registry.h"

#include <fmt/format.h>

#include "failure/failure.h"
#include "settings/nearest_word.h"

namespace abbe::simulation {

const std::vector<Cause>& Causes() {
  static const std::vector<Cause> causes{Backlash(),
                                         LeadscrewCyclic(),
                                         ScaleError(),
                                         Squareness(),
                                         ThermalGrowth(),
                                         WarmUpDrift(),
                                         PivotWarmUp(),
                                         ServoLag(),
                                         ServoLagMismatch(),
                                         ReversalSpike(),
                                         LoadCoupling(),
                                         Vibration(),
                                         ProbeGain(),
                                         ProbeNonlinearity(),
                                         ProbePosition(),
                                         ProbeTiltResponse(),
                                         ProbeCrosstalk(),
                                         TargetForm(),
                                         ChannelSwap(),
                                         ChannelSign(),
                                         MainsPickup(),
                                         EncoderEccentricity(),
                                         EncoderSubdivision(),
                                         EncoderCountSlip(),
                                         BearingRoundness(),
                                         LinkThermalGrowth(),
                                         LinkGravityBend(),
                                         JointHysteresis(),
                                         JointGain(),
                                         CapFriction(),
                                         CapTrailing(),
                                         ClockSkew(),
                                         FixtureMisalignment(),
                                         TargetEccentricity(),
                                         TargetLobing(),
                                         ShaftErrorMotion(),
                                         SensorGain(),
                                         SensorNonlinearity(),
                                         ShaftClockSkew(),
                                         StuckChannel(),
                                         Outliers()};
  return causes;
}

const Cause& CauseNamed(const std::string& id) {
  std::vector<std::string> names;
  for (const Cause& cause : Causes()) {
    if (cause.id == id) return cause;
    names.push_back(cause.id);
  }
  throw InputError(fmt::format("no cause \"{}\" is known; the nearest is \"{}\"", id,
                               settings::NearestWord(id, names)));
}

}  // namespace abbe::simulation
