#include "hal/device_settings.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "../folders.h"
#include "hal/modbus/modbus_device.h"

namespace abbe::hal {
namespace device_settings_test {

std::vector<ModbusSettings> Read(const std::string& text) {
  return SettingsOf<ModbusDevice>(
      ReadDevices(settings::Document::Parse(text, "m.toml").Root().Child("devices")));
}

std::string Refusal(const std::string& text) {
  try {
    Read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

constexpr char kHead[] = "[devices.d]\nhost = 'h'\n";
std::string WithBlock(const std::string& block) {
  return std::string(kHead) + "[[devices.d.block]]\n" + block;
}

TEST(DeviceSettings, ReadsTheDemonstrationMachine) {
  const auto file = settings::Document::Read(DemoMillFile());
  const DevicesSettings all = ReadDevices(file.Root().Child("devices"));
  EXPECT_EQ(all.rate, 200.0);
  EXPECT_DOUBLE_EQ(all.max_skew, 0.02);
  EXPECT_EQ(all.stale, 1.0);
  const auto over_modbus = SettingsOf<ModbusDevice>(all);
  ASSERT_EQ(over_modbus.size(), 2u);
  const ModbusSettings& head = over_modbus[0];
  EXPECT_EQ(head.name, "head");
  EXPECT_EQ(PlaceOf(head), "127.0.0.1 port 1502, unit 1");
  ASSERT_EQ(head.blocks.size(), 1u);
  EXPECT_EQ(head.blocks[0].table, RegisterTable::kInput);
  ASSERT_EQ(head.blocks[0].channels.size(), 5u);
  const ChannelSettings& probe = head.blocks[0].channels[4];
  EXPECT_EQ(probe.name, "probe_e_um");
  EXPECT_EQ(probe.sentinels, std::vector<double>{65535});
  const std::array<std::uint16_t, 5> words{0, 0, 0, 0, 32768};
  EXPECT_EQ(ValueOf(probe, RawOf(probe, words)), 100.0);  // half of 65536 steps over 200 um
  const ModbusSettings& machine = over_modbus[1];
  ASSERT_TRUE(machine.cycle_start.has_value());
  EXPECT_EQ(machine.cycle_start->address, 100);
  EXPECT_TRUE(machine.blocks[0].channels[0].may_freeze);
}

TEST(DeviceSettings, KeepsTheOrderOfTheFileAndLeavesEncodersOut) {
  const auto file = settings::Document::Read(DemoMillFile());
  const DevicesSettings all = ReadDevices(file.Root().Child("devices"));
  const auto names = [](const DevicesSettings& devices) {
    std::vector<std::string> list;
    for (const auto& device : devices.devices) list.push_back(device->name());
    return list;
  };
  EXPECT_EQ(names(all), (std::vector<std::string>{"head", "machine", "linkage"}));
  EXPECT_EQ(names(WithoutEncoders(all)), (std::vector<std::string>{"head", "machine"}));
  // A device that only starts the machine's program has no channel, and stays.
  const auto starter = settings::Document::Parse(
      "[devices.a]\nhost = 'h'\nblock = [{address = 0, count = 1}]\n[devices.b]\nhost = 'h'\nblock "
      "= [{address = 0, count = 1, channel = [{name = 'x_mm', at = 0, type = 'int16'}]}]\n",
      "m.toml");
  EXPECT_EQ(WithoutEncoders(ReadDevices(starter.Root().Child("devices"))).devices.size(), 2u);
}

TEST(DeviceSettings, StoresWhatItReads) {
  const auto all =
      Read(WithBlock("function = 'holding'\naddress = 0\ncount = 2\n"
                     "channel = [{name = 'x_mm', at = 0, type = 'int32', order = 'CDAB', scale = "
                     "1e-5, offset = 2}]"));
  const ChannelSettings& channel = all[0].blocks[0].channels[0];
  std::array<std::uint16_t, 2> block{};
  StoreValue(channel, 2.0 - 1e-5, block);  // raw -1
  EXPECT_EQ(block, (std::array<std::uint16_t, 2>{0xFFFF, 0xFFFF}));
  StoreValue(channel, 2.0 + 0.65537, block);  // raw 65537 = 0001 0001h
  EXPECT_EQ(block, (std::array<std::uint16_t, 2>{1, 1}));
  EXPECT_DOUBLE_EQ(ValueOf(channel, RawOf(channel, block)), 2.65537);
}

TEST(DeviceSettings, TakesTheAddressBaseOffEveryAddress) {
  const auto all = Read(
      "[devices.d]\nhost = 'h'\naddress_base = 1\n"
      "cycle_start = {function = 'holding', address = 101}\n"
      "[[devices.d.block]]\nfunction = 'input'\naddress = 9\ncount = 60\n"
      "channel = [{name = 'a_um', at = 2, type = 'float32', status = {address = 61, ok = [0, "
      "1]}}]");
  const ModbusSettings& device = all[0];
  EXPECT_EQ(device.blocks[0].address, 8);
  EXPECT_EQ(device.cycle_start->address, 100);
  EXPECT_EQ(device.blocks[0].channels[0].status->address, 60);
  EXPECT_EQ(device.blocks[0].channels[0].status->ok, (std::vector<std::uint16_t>{0, 1}));
}

TEST(DeviceSettings, ReadsASerialLine) {
  const auto all = Read(
      "[devices.d]\ntransport = 'modbus-rtu'\nunit = 7\n"
      "serial = {device = '/dev/ttyUSB0', baud = 9600, parity = 'none', stop_bits = 2}\n"
      "[[devices.d.block]]\naddress = 0\ncount = 1\nchannel = [{name = 'a', at = 0, type = "
      "'int16'}]");
  EXPECT_EQ(PlaceOf(all[0]), "/dev/ttyUSB0, unit 7");
  EXPECT_EQ(all[0].serial.baud, 9600);
  EXPECT_EQ(all[0].serial.parity, 'N');
  EXPECT_EQ(all[0].serial.stop_bits, 2);
  EXPECT_DOUBLE_EQ(all[0].times.wait, 5e-3);
}

// A larger one would switch the promise of a common time off.
TEST(DeviceSettings, BoundsTheSkew) {
  for (const char* skew : {"1e300", "inf", "10001", "0", "-1", "nan"}) {
    EXPECT_EQ(Refusal(std::string("[devices]\nmax_skew_ms = ") + skew + "\n").substr(0, 30),
              "m.toml:2: devices.max_skew_ms:")
        << skew;
  }
}

TEST(DeviceSettings, RefusesWithLineKeyAndRemedy) {
  EXPECT_EQ(Refusal(WithBlock("address = 0\ncount = 126")),
            "m.toml:5: devices.d.block[0].count: is 126, it must be at most 125");
  EXPECT_EQ(Refusal(WithBlock("address = 65530\ncount = 7")),
            "m.toml:5: devices.d.block[0].count: reaches beyond the last register, 65535");
  EXPECT_EQ(Refusal(WithBlock("address = 0\ncount = 2\nchannel = [{name = 'a', at = 1, type = "
                              "'int32'}]")),
            "m.toml:6: devices.d.block[0].channel[0].at: lies outside the block of 2 registers");
  // 32 bits do not hold these: taken as 0, and beyond the block.
  for (const char* at : {"4294967296", "2147483647"}) {
    EXPECT_EQ(
        Refusal(WithBlock(std::string("address = 0\ncount = 2\nchannel = [{name = 'a', at = ") +
                          at + ", type = 'int32'}]")),
        std::string("m.toml:6: devices.d.block[0].channel[0].at: is ") + at +
            ", it must be at most 1");
  }
  EXPECT_EQ(Refusal("[devices.d]\ntransport = 'modbus-rtu'\n[devices.d.serial]\ndevice = 't'\n"
                    "baud = 4294976896\n"),
            "m.toml:5: devices.d.serial.baud: is 4294976896, it must be at most 4000000");
  EXPECT_EQ(Refusal(WithBlock("address = 0\ncount = 2\nchannel = [{name = 'a', at = 1, type = "
                              "'int16', scal = 2}]")),
            "m.toml:6: devices.d.block[0].channel[0].scal: is not a known key; did you mean "
            "\"scale\"?");
  EXPECT_EQ(Refusal(WithBlock("address = 0\ncount = 2\nchannel = [{name = 'a', at = 1, type = "
                              "'int16', status = {address = 9}}]")),
            "m.toml:3: devices.d.block: the status register of a lies in no block; add a "
            "[[devices.d.block]] without channels that covers it");
  EXPECT_EQ(Refusal(WithBlock("address = 0\ncount = 1\nchannel = [{name = 'a', at = 0, type = "
                              "'int16'}, {name = 'a', at = 0, type = 'int16'}]")),
            "m.toml:3: devices.d.block: the channel name \"a\" is used twice");
  EXPECT_EQ(Refusal("[devices.d]\nhost = 'h'"),
            "m.toml:1: devices.d.block: is missing; a device has at least one");
  EXPECT_EQ(Refusal("[devices.d]\nhost = 'h'\ndeadline_ms = 100\n[[devices.d.block]]\naddress = "
                    "0\ncount = 1"),
            "m.toml:3: devices.d.deadline_ms: must not be shorter than response_timeout_ms");
  EXPECT_EQ(Refusal("[devices]\nrate_hz = 100"),
            "m.toml:1: devices: has no device with a channel; add a table [devices.NAME]");
  EXPECT_EQ(
      Refusal("[devices]\nrate_hx = 100\n[devices.d]\nhost = 'h'\n[[devices.d.block]]\naddress "
              "= 0\ncount = 1\nchannel = [{name = 'a', at = 0, type = 'int16'}]"),
      "m.toml:2: devices.rate_hx: is not a known key; did you mean \"rate_hz\"?");
}

}  // namespace device_settings_test
}  // namespace abbe::hal
