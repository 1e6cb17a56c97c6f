// A transport: a way to reach a device, which `transport` in its table [devices.NAME] selects.
//
// To add one: a folder hal/NAME/ with
//
//   a Device           the settings of the table
//   a DeviceSource     the open device
//   a function         that reads the table into a Device
//   a CMakeLists.txt   the sources, and the libraries that only they use
//
// and one line in transports.cpp, which gives the function the transport's name. No other file may
// compare it. tests/hal/transport_contract_test.cpp checks this contract for every transport.
// Units: s.
// Failure: DeviceError from Require and StartCycle.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/clock.h"
#include "hal/sample_source.h"
#include "settings/document.h"

namespace abbe::hal {

// An open device. The contract of SampleSource holds.
class DeviceSource : public SampleSource {
 public:
  // DeviceError, with the device, its address, its answer and the remedy, unless every channel can
  // be read now.
  virtual void Require() = 0;
  // The protocol, and what the device answered Require() about itself, for the header of a
  // recording: "modbus, Moxa E1240 2.1".
  virtual std::string Description() const = 0;

  virtual bool HasCycleStart() const { return false; }
  // Starts a program of the machine; 1, 2, 3 are the sweeps of X, Y, Z. DeviceError when the device
  // refuses. Precondition: HasCycleStart().
  virtual void StartCycle(int /*program*/) {}
};

// A device as its table describes it.
class Device {
 public:
  virtual ~Device() = default;
  virtual const std::string& name() const = 0;  // NAME of [devices.NAME]
  // The names of its channels, in the order of the table.
  virtual std::vector<std::string> channels() const = 0;
  // The key of the table that lists them, for messages: "block".
  virtual std::string_view channels_key() const = 0;
  // Does not wait for the device. `clock` must outlive the source; `stale_s` as in DevicesSettings.
  // DeviceError when a host name cannot be resolved.
  virtual std::unique_ptr<DeviceSource> Open(Clock& clock, double stale_s,
                                             const Log& log) const = 0;
};

struct Transport {
  std::string name;  // the value of `transport`
  // InputError with file, line and key. Keys that it does not ask for are refused by ReadDevices().
  std::function<std::shared_ptr<const Device>(const settings::Table& device)> read;
};

}  // namespace abbe::hal
