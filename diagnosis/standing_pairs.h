// Pairs of axes, of which one never moves in the runs at hand.
//
// A cause at such a pair shows the other axis alone: a mismatch of its lag with no lag is that lag
// under a second name. It is no candidate, and the runs cannot show it.
#pragma once

#include <string>
#include <vector>

#include "simulation/causes/cause.h"

namespace abbe::diagnosis {

bool IsStandingPair(const simulation::Scene& scene, const simulation::Object& object);

// Names of causes at pairs of axes that the machine has: "servo-lag-mismatch:XZ".
std::vector<std::string> StandingPairs(const simulation::Scene& scene);

}  // namespace abbe::diagnosis
