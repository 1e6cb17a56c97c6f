#include "hal/device_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace abbe::hal {
namespace {

using settings::Table;

std::shared_ptr<const Device> ReadDevice(const Table& table,
                                         const std::vector<Transport>& transports) {
  std::vector<std::string> names;
  names.reserve(transports.size());
  for (const Transport& transport : transports) names.push_back(transport.name);
  const std::string name = table.Choice("transport", names);
  auto device = std::ranges::find(transports, name, &Transport::name)->read(table);
  table.RefuseUnknown();
  return device;
}

}  // namespace

DevicesSettings ReadDevices(const Table& devices, const std::vector<Transport>& transports) {
  DevicesSettings all;
  all.rate = devices.Quantity("rate_hz", {.fallback = 200.0, .above = 0.0, .at_most = 1e5});
  all.max_skew = devices.Quantity("max_skew_ms", {.fallback = 20.0, .above = 0.0, .at_most = 10e3});
  all.stale = devices.Quantity("stale_ms", {.fallback = 1000.0, .above = 0.0, .at_most = 60e3});
  std::set<std::string> names;
  for (const Table& table : devices.Named()) {
    all.devices.push_back(ReadDevice(table, transports));
    const Device& device = *all.devices.back();
    for (const std::string& name : device.channels()) {
      if (names.insert(name).second) continue;
      throw table.Error(device.channels_key(),
                        fmt::format("the channel name \"{}\" is used twice", name));
    }
  }
  devices.RefuseUnknown();
  if (names.empty()) {
    throw devices.Error("", "has no device with a channel; add a table [devices.NAME]");
  }
  return all;
}

DevicesSettings WithoutEncoders(DevicesSettings devices) {
  std::erase_if(devices.devices, [](const auto& device) {
    const std::vector<std::string> names = device->channels();
    const auto is_angle = [](const std::string& name) { return name.ends_with("_rad"); };
    return !names.empty() && std::ranges::all_of(names, is_angle);
  });
  return devices;
}

}  // namespace abbe::hal
