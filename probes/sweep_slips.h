// What a sweep shows when its numbers are not those of the axes and the probes: registers that are
// misread, units that are mistaken, an amplifier that is off.
//
// Refused, for no error can follow from them: positions far outside the travels
// (machine/plausible_position.h), probes that show the same in every dwell, five gaps that are next
// to nothing beside the probes' ranges. Said in a note, for they may be true: no noise at all,
// noise a hundred times what the machine file states or a hundredth of it, passes that agree far
// better than their noise allows.
//
// Failure: InputError naming the recording, the row or the probe, and what to do.
#pragma once

#include <string>
#include <vector>

#include "machine/machine.h"
#include "probes/head_settings.h"
#include "probes/sweep_dwells.h"
#include "probes/sweep_stations.h"

namespace abbe::probes {

// `name` stands for the recording in messages.
void RefuseSlips(const std::string& name, const SweepDwells& sweep, const machine::Machine& machine,
                 const HeadSettings& head);

// One sentence each.
std::vector<std::string> SlipNotes(const SweepDwells& sweep, const NoiseFigures& noise,
                                   const ProbeNoise& stated);

}  // namespace abbe::probes
