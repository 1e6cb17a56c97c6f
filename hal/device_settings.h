// The devices as the machine file describes them: tables [devices] and [devices.NAME]. Every key,
// with unit and default, is in docs/devices.md.
//
//   const DevicesSettings devices = ReadDevices(document.Root().Child("devices"));
//   const OpenedDevices opened = OpenDevices(devices, clock, Presence::kRequired);
//
// Units: Hz, s.
// Failure: InputError with file, line and key.
// Source: docs/devices.md.
#pragma once

#include <memory>
#include <vector>

#include "hal/transports.h"
#include "settings/document.h"

namespace abbe::hal {

struct DevicesSettings {
  double rate = 200.0;     // Hz, readings of all devices wanted
  double max_skew = 0.02;  // s, within one set of samples
  double stale = 1.0;      // s, older or unchanged for longer is not good
  std::vector<std::shared_ptr<const Device>> devices;  // in the order of the file
};

// Reads the table [devices]. InputError with file, line and key.
DevicesSettings ReadDevices(const settings::Table& devices,
                            const std::vector<Transport>& transports = Transports());

// `devices` without those whose channels are all angles ("..._rad"): the encoders of a linkage,
// which is not on the machine while the probe head is.
DevicesSettings WithoutEncoders(DevicesSettings devices);

// The settings of the devices of one class, such as ModbusDevice: for a server of its protocol.
template <class OneDevice>
std::vector<typename OneDevice::Settings> SettingsOf(const DevicesSettings& devices) {
  std::vector<typename OneDevice::Settings> settings;
  for (const auto& device : devices.devices) {
    const auto* one = dynamic_cast<const OneDevice*>(device.get());
    if (one != nullptr) settings.push_back(one->settings());
  }
  return settings;
}

}  // namespace abbe::hal
