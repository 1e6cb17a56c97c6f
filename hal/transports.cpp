#include "hal/transports.h"

#include "hal/can/canopen_device.h"
#include "hal/modbus/example_devices.h"
#include "hal/modbus/modbus_device.h"

namespace abbe::hal {

const std::vector<Transport>& Transports() {
  static const std::vector<Transport> transports{
      {"modbus-tcp", ReadModbusTcp},
      {"modbus-rtu", ReadModbusRtu},
      {"canopen", ReadCanopenDevice},
  };
  return transports;
}

std::string ExampleDevices(std::string_view axes) { return ExampleModbusDevices(axes); }

}  // namespace abbe::hal
