// The transport of CANopen: encoders on a CAN bus.
// Failure: InputError with file, line and key from ReadCanopenDevice; DeviceError from Open.
// Source: CiA 301, CiA 406.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/can/can_bus.h"
#include "hal/can/canopen_settings.h"
#include "hal/transport.h"

namespace abbe::hal {

class CanopenDevice : public Device {
 public:
  using Settings = CanopenSettings;
  // The bus behind an interface's name.
  using BusOf = std::function<std::unique_ptr<CanBus>(const std::string& interface, Clock& clock)>;

  // On an interface of the computer, or on what `bus_of` gives (a bus in memory).
  explicit CanopenDevice(CanopenSettings settings, BusOf bus_of = {})
      : settings_(std::move(settings)), bus_of_(std::move(bus_of)) {}
  const CanopenSettings& settings() const { return settings_; }

  const std::string& name() const override { return settings_.name; }
  std::vector<std::string> channels() const override;
  std::string_view channels_key() const override { return "node"; }
  // Listens at once, sends nothing yet.
  std::unique_ptr<DeviceSource> Open(Clock& clock, double stale_s, const Log& log) const override;

 private:
  CanopenSettings settings_;
  BusOf bus_of_;
};

// The table of one device.
std::shared_ptr<const Device> ReadCanopenDevice(const settings::Table& device);

}  // namespace abbe::hal
