// The transports of Modbus: over TCP, and over a serial line (RTU).
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
  std::unique_ptr<DeviceSource> Open(Clock& clock, double stale_s, const Log& log) const override;

 private:
  ModbusSettings settings_;
};

std::shared_ptr<const Device> ReadModbusTcp(const settings::Table& device);
std::shared_ptr<const Device> ReadModbusRtu(const settings::Table& device);

}  // namespace abbe::hal
