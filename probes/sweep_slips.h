// Checks of a sweep for readings that are not those of its axes and probes: wrong registers, wrong
// units, an amplifier that is switched off.
//
// RefuseSlips throws where no result is possible: positions far outside the travels
// (machine/plausible_position.h), a probe with the same reading in every dwell, five gaps that are
// below 1/500 of the ranges. SlipNotes warns where the readings may be true: no noise at all, noise
// a hundred times that of the machine file or a hundredth of it, passes that agree far better than
// their noise allows.
//
// Failure: InputError with the recording, the row or the probe, and what to do.
#pragma once

#include <string>
#include <vector>

#include "machine/machine.h"
#include "probes/head_settings.h"
#include "probes/station_means.h"
#include "probes/sweep_dwells.h"

namespace abbe::probes {

// `name` is the recording in messages.
void RefuseSlips(const std::string& name, const SweepDwells& sweep, const machine::Machine& machine,
                 const HeadSettings& head);

// Warnings for the user, one sentence each.
std::vector<std::string> SlipNotes(const SweepDwells& sweep, const NoiseFigures& noise,
                                   const ProbeNoise& stated);

}  // namespace abbe::probes
