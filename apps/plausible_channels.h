// What the channels of a machine file can read, from what the file says of the machine and its
// probes.
#pragma once

#include <vector>

#include "apps/machine_file.h"
#include "hal/plausible_source.h"

namespace abbe::apps {

// x_mm, y_mm, z_mm: machine/plausible_position.h. probe_a_um to probe_e_um: 0 to the probe's range
// is good; a range beyond that still is what an amplifier may show that sees no target.
std::vector<hal::PlausibleChannel> PlausibleChannels(const MachineFile& file);

}  // namespace abbe::apps
