#include "hal/can/canopen_device.h"

#include "hal/can/can_socket.h"
#include "hal/can/canopen_source.h"

namespace abbe::hal {

std::vector<std::string> CanopenDevice::channels() const {
  std::vector<std::string> names;
  for (const EncoderSettings& encoder : settings_.encoders) names.push_back(encoder.name);
  return names;
}

std::unique_ptr<DeviceSource> CanopenDevice::Open(Clock& clock, double stale_s,
                                                  const Log& log) const {
  auto bus = bus_of_ ? bus_of_(settings_.interface, clock)
                     : std::make_unique<CanSocket>(settings_.interface, clock);
  return std::make_unique<CanopenSource>(settings_, stale_s, std::move(bus), clock, log);
}

std::shared_ptr<const Device> ReadCanopenDevice(const settings::Table& device) {
  return std::make_shared<CanopenDevice>(ReadCanopen(device));
}

}  // namespace abbe::hal
