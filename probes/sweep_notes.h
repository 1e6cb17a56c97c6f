// What the result of a sweep rests on that the sweep itself does not check, for the user.
//
// Frames: M. Units: SI. Shapes: `errors` as GroupErrors; one standard uncertainty for each component.
// Failure: none. Source: docs/sweep.md. For use within probes/ only.
// Validity: that of the budget in `result`.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "probes/head_settings.h"
#include "probes/sweep_gauge.h"
#include "probes/sweep_result.h"

namespace abbe::probes {

using PerComponent = std::array<double, kComponents>;

// One sentence each. `usual_linearity`: what probes of usual linearity would add.
std::vector<std::string> NotesOn(const SweepResult& result, const StationMeans& means,
                                 const GroupErrors& errors, const SweepGauge& gauge,
                                 const HeadSettings& head, const TargetSettings& target,
                                 const PerComponent& usual_linearity);

}  // namespace abbe::probes
