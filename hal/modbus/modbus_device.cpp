#include "hal/modbus/modbus_device.h"

#include "hal/modbus/modbus_source.h"

namespace abbe::hal {

std::vector<std::string> ModbusDevice::channels() const {
  std::vector<std::string> names;
  for (const BlockSettings& block : settings_.blocks) {
    for (const ChannelSettings& channel : block.channels) names.push_back(channel.name);
  }
  return names;
}

std::unique_ptr<DeviceSource> ModbusDevice::Open(Clock& clock, double stale_s,
                                                 const Log& log) const {
  return std::make_unique<ModbusSource>(settings_, stale_s, clock, log);
}

std::shared_ptr<const Device> ReadModbusTcp(const settings::Table& device) {
  return std::make_shared<ModbusDevice>(ReadModbus(device, ModbusFraming::kTcp));
}

std::shared_ptr<const Device> ReadModbusRtu(const settings::Table& device) {
  return std::make_shared<ModbusDevice>(ReadModbus(device, ModbusFraming::kRtu));
}

}  // namespace abbe::hal
