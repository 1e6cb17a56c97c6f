#include "apps/plausible_channels.h"

#include <fmt/format.h>

#include "machine/plausible_position.h"
#include "settings/unit.h"

namespace abbe::apps {

std::vector<hal::PlausibleChannel> PlausibleChannels(const MachineFile& file) {
  using settings::kMicrometre;
  using settings::kMillimetre;
  constexpr double kStill = 5e-6;  // m: above the noise of scales, below a move
  std::vector<hal::PlausibleChannel> channels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const machine::Travel& travel = file.sweep_setup.machine.travels[axis];
    const machine::Travel span = machine::PlausiblePositions(travel);
    const bool exists = travel.last > travel.first;
    const hal::Interval possible{span.first / kMillimetre, span.last / kMillimetre};
    channels.push_back({fmt::format("{}_mm", "xyz"[axis]), possible, possible,
                        exists ? fmt::format("the travel is {:.6g} to {:.6g} mm",
                                             travel.first / kMillimetre, travel.last / kMillimetre)
                               : fmt::format("the machine has no axis {:c}", "XYZ"[axis]),
                        0.0, 0.0, kStill / kMillimetre});
  }
  for (std::size_t probe = 0; probe < probes::kProbes; ++probe) {
    constexpr double kNextToNothing = 1 / 500.0;
    const double range = file.sweep_setup.head.probes[probe].range / kMicrometre;
    channels.push_back({fmt::format("probe_{:c}_um", 'a' + probe),
                        {0.0, range},
                        {-range, 2.0 * range},
                        fmt::format("the probe's range is 0 to {:.6g} um", range),
                        kNextToNothing * range,
                        file.sweep_setup.noise.probe / kMicrometre});
  }
  return channels;
}

PlausibleDevices OpenPlausible(const MachineFile& file, const hal::DevicesSettings& devices,
                               int readings, hal::Clock& clock) {
  const auto opened = std::make_shared<bool>(false);  // an earlier failure is thrown
  PlausibleDevices plausible{hal::OpenDevices(devices, clock, hal::Presence::kRequired,
                                              [opened](const std::string& line) {
                                                if (*opened) fmt::print(stderr, "abbe: {}\n", line);
                                              }),
                             nullptr,
                             {}};
  *opened = true;
  plausible.source =
      std::make_unique<hal::PlausibleSource>(*plausible.devices.source, PlausibleChannels(file));
  plausible.warnings = plausible.source->Require(readings, clock, file.devices.rate);
  return plausible;
}

}  // namespace abbe::apps
