// The transports of Modbus: over TCP, and over a serial line (RTU).
// Failure: InputError with file, line and key from the readers; DeviceError from Open.
// Source: docs/devices.md.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/modbus/modbus_settings.h"
#include "hal/transport.h"

namespace abbe::hal {

class ModbusDevice : public Device {
 public:
  using Settings = ModbusSettings;

  explicit ModbusDevice(ModbusSettings settings) : settings_(std::move(settings)) {}
  const ModbusSettings& settings() const { return settings_; }

  const std::string& name() const override { return settings_.name; }
  std::vector<std::string> channels() const override;
  std::string_view channels_key() const override { return "block"; }
  // Connects at the first reading.
  std::unique_ptr<DeviceSource> Open(Clock& clock, double stale_s, const Log& log) const override;

 private:
  ModbusSettings settings_;
};

// `host`, `port`, `unit` and the blocks.
std::shared_ptr<const Device> ReadModbusTcp(const settings::Table& device);
// `device`, `baud`, `parity`, `unit` and the blocks.
std::shared_ptr<const Device> ReadModbusRtu(const settings::Table& device);

}  // namespace abbe::hal
