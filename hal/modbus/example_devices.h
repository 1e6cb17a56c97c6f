// Tables [devices] of a machine file, to be filled in: a probe amplifier and a control over Modbus
// TCP.
//
//   ExampleModbusDevices("XYZ");
//
// Units: in the names of the channels. Failure: none. Source: docs/devices.md.
// Validity: the registers of the virtual rig of machines/demo_mill.toml.
#pragma once

#include <string>
#include <string_view>

namespace abbe::hal {

// With a scale for each letter of `axes`, of X, Y and Z.
std::string ExampleModbusDevices(std::string_view axes);

}  // namespace abbe::hal
