// docs/devices.md: its examples are read as they stand and give the values that the makers' manuals
// say; every key that the readers ask for is on the page.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>
#include <vector>

#include "../folders.h"
#include "hal/can/canopen_device.h"
#include "hal/device_settings.h"
#include "hal/modbus/channel_judge.h"
#include "hal/modbus/modbus_device.h"
#include "hal/sweep_plan.h"

namespace abbe::hal {
namespace devices_page_test {

std::string Page() {
  std::ifstream file(SourceFolder() / "docs/devices.md");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The settings of the devices of one class in all examples.
template <class OneDevice>
std::vector<typename OneDevice::Settings> Examples() {
  const std::string page = Page(), open = "```toml\n";
  std::vector<typename OneDevice::Settings> examples;
  for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at)) {
    at += open.size();
    const std::string text = page.substr(at, page.find("```", at) - at);
    const auto document = settings::Document::Parse(text, "docs/devices.md");
    const auto read = SettingsOf<OneDevice>(ReadDevices(document.Root().Child("devices")));
    examples.insert(examples.end(), read.begin(), read.end());
  }
  return examples;
}

// What the first channel of an example makes of the registers of its block.
Sample Judged(const ModbusSettings& device,
              const std::vector<std::pair<int, std::uint16_t>>& words) {
  const BlockSettings& block = device.blocks[0];
  std::vector<std::uint16_t> registers(static_cast<std::size_t>(block.count));
  for (const auto& [address, word] : words) {
    registers[static_cast<std::size_t>(address - block.address)] = word;
  }
  const ChannelSettings& channel = block.channels[0];
  std::optional<std::uint16_t> status;
  if (channel.status) {
    status = registers[static_cast<std::size_t>(channel.status->address - block.address)];
  }
  ChannelJudge judge(channel, 1.0);
  return judge.Judge(registers, status, 0.0, 0.0);
}

TEST(DevicesPage, TheGenericModuleReadsItsWholeRange) {
  const ModbusSettings module = Examples<ModbusDevice>().at(0);
  EXPECT_NEAR(Judged(module, {{0, 65534}}).value, 200.0 * 65534 / 65535, 1e-4);
  EXPECT_NEAR(Judged(module, {{0, 32768}}).value, 100.0, 2e-3);
  EXPECT_EQ(Judged(module, {{0, 65535}}).cause, Cause::kSentinel);
  EXPECT_EQ(Judged(module, {{0, 0}}).cause, Cause::kSentinel);
}

TEST(DevicesPage, TheMoxaReadsVoltsAndItsStatus) {
  const ModbusSettings moxa = Examples<ModbusDevice>().at(1);
  EXPECT_EQ(Judged(moxa, {{8, 0x40A0}, {9, 0x0000}}).value, 100.0);  // 40A00000h = 5.0 V
  EXPECT_EQ(Judged(moxa, {{8, 0x40A0}, {60, 1}}).cause, Cause::kSensorFault);
  EXPECT_EQ(moxa.blocks[0].channels[4].status->address, 64);
}

TEST(DevicesPage, TheWagoReadsItsModuleAndTheStatusBits) {
  const ModbusSettings wago = Examples<ModbusDevice>().at(2);
  EXPECT_EQ(Judged(wago, {{0, 0x4000}}).value, 100.0);  // 5 V
  EXPECT_EQ(Judged(wago, {{0, 0x8000}}).value, -200.0);
  EXPECT_EQ(Judged(wago, {{0, 0x7FF9}}).cause, Cause::kSensorFault);
  EXPECT_EQ(Judged(wago, {{0, 0x8001}}).cause, Cause::kSensorFault);
}

TEST(DevicesPage, TheEncodersGoTheirWay) {
  const CanopenSettings linkage = Examples<CanopenDevice>().at(0);
  ASSERT_EQ(linkage.encoders.size(), 3u);
  EXPECT_EQ(linkage.encoders[0].range, std::int64_t{1} << 30);  // 4096 turns
  EXPECT_EQ(CountOf(linkage.encoders[0], std::numbers::pi), 131072);
  EXPECT_EQ(CountOf(linkage.encoders[1], std::numbers::pi), (1 << 30) - 131072);
  EXPECT_EQ(linkage.encoders[2].range, 65536);
}

TEST(DevicesPage, NamesEveryKey) {
  const auto document = settings::Document::Parse(
      R"([devices.a]
host = "h"
[[devices.a.block]]
address = 0
count = 2
channel = [{name = "a", at = 0, type = "int16", minimum = 0, maximum = 1, status = {at = 0}},
           {name = "b", at = 0, type = "int16", status = {address = 1}}]
[devices.b]
transport = "modbus-rtu"
cycle_start = {address = 3}
serial = {device = "d"}
[[devices.b.block]]
address = 0
count = 1
[devices.c]
transport = "canopen"
interface = "can0"
node = [{id = 1, name = "pivot_1_rad", counts_per_turn = 16, serial = 1}]
[sweep.X]
first_mm = 0
last_mm = 1
step_mm = 1
)",
      "keys");
  ReadDevices(document.Root().Child("devices"));
  ReadSweepPlan(document.Root().Child("sweep"), 'X');
  const std::string page = Page();
  EXPECT_GT(document.requested().size(), 60u);
  for (const auto& [path, asked] : document.requested()) {
    const std::string key = path.substr(path.rfind('.') + 1);
    const bool table = path == "devices" || path == "sweep" || key.size() == 1;  // [sweep.X]
    if (table) continue;
    const bool named = page.find("`" + key + "`") != std::string::npos ||
                       page.find("[" + key + "]") != std::string::npos;
    EXPECT_TRUE(named) << path;
  }
}

}  // namespace devices_page_test
}  // namespace abbe::hal
