// The plausible ranges of the channels of a machine file, from its machine and probes.
#pragma once

#include <vector>

#include "apps/machine_file.h"
#include "hal/plausible_source.h"

namespace abbe::apps {

// x_mm, y_mm, z_mm: machine/plausible_position.h. probe_a_um to probe_e_um: valid from
// 0 to the range of the probe, possible from minus the range to twice the range, which
// an amplifier may show without a target.
std::vector<hal::PlausibleChannel> PlausibleChannels(const MachineFile& file);

}  // namespace abbe::apps
