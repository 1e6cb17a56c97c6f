// The devices of a machine file, opened and checked, with the plausible ranges of their channels
// from its machine and probes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/machine_file.h"
#include "hal/combined_source.h"
#include "hal/plausible_source.h"

namespace abbe::apps {

// x_mm, y_mm, z_mm: machine/plausible_position.h. probe_a_um to probe_e_um: valid from
// 0 to the range of the probe, possible from minus the range to twice the range, which
// an amplifier may show without a target.
std::vector<hal::PlausibleChannel> PlausibleChannels(const MachineFile& file);

struct PlausibleDevices {
  hal::OpenedDevices devices;
  std::unique_ptr<hal::PlausibleSource> source;  // reads `devices`
  std::vector<std::string> warnings;             // of the first readings
};

// Checked before anything moves.
inline constexpr int kFirstReadings = 50;

// Opens `devices` of the file and takes `readings` readings of them, before anything moves. What
// they report later goes to standard error. DeviceError as hal::OpenDevices and
// hal::PlausibleSource::Require.
PlausibleDevices OpenPlausible(const MachineFile& file, const hal::DevicesSettings& devices,
                               int readings, hal::Clock& clock);

}  // namespace abbe::apps
