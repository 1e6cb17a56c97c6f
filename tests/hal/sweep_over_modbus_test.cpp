// A whole sweep over real sockets into a real file, with a server that vanishes in the middle of
// it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <thread>

#include "hal/combined_source.h"
#include "hal/modbus/modbus_device.h"
#include "hal/modbus/modbus_server.h"
#include "hal/sweep_recorder.h"
#include "recording/instant.h"
#include "swept_machine.h"

namespace abbe::hal {
namespace sweep_over_modbus_test {

constexpr char kDevices[] = R"(
[devices.head]
host = "127.0.0.1"
port = 1
unit = 1
deadline_ms = 5000
response_timeout_ms = 2000
backoff_first_ms = 20
backoff_most_ms = 20
[[devices.head.block]]
address = 0
count = 5
channel = [
  { name = "probe_a_um", at = 0, type = "uint16", scale = 0.003 },
  { name = "probe_b_um", at = 1, type = "uint16", scale = 0.003 },
  { name = "probe_c_um", at = 2, type = "uint16", scale = 0.003 },
  { name = "probe_d_um", at = 3, type = "uint16", scale = 0.003 },
  { name = "probe_e_um", at = 4, type = "uint16", scale = 0.003 },
]
[devices.machine]
host = "127.0.0.1"
port = 1
unit = 2
deadline_ms = 5000
response_timeout_ms = 2000
backoff_first_ms = 20
backoff_most_ms = 20
[[devices.machine.block]]
function = "holding"
address = 0
count = 2
channel = [{ name = "x_mm", at = 0, type = "int32", scale = 0.00001, may_freeze = true }]
)";

// Probes and scale of a machine that moves by the clock.
class MovingBank : public RegisterBank {
 public:
  MovingBank(const std::vector<ModbusSettings>& devices, const SweepPlan& plan, Clock& clock)
      : devices_(devices), machine_(plan, 0.0, 0.5), clock_(clock) {}
  const SweptMachine& machine() const { return machine_; }

  Answer Read(int unit, RegisterTable, int, std::span<std::uint16_t> words) override {
    const double now = clock_.Now();
    for (const ChannelSettings& channel :
         devices_[static_cast<std::size_t>(unit - 1)].blocks[0].channels) {
      const double value = channel.name == "x_mm" ? 1e3 * machine_.PositionAt(now)
                                                  : 100.0 + 10.0 * std::sin(50.0 * now);
      StoreValue(channel, value, words);
    }
    return Answer::kOk;
  }

 private:
  const std::vector<ModbusSettings>& devices_;
  SweptMachine machine_;
  Clock& clock_;
};

TEST(SweepOverModbus, GoesOnWhenTheServerVanishesAndReturns) {
  DevicesSettings devices =
      ReadDevices(settings::Document::Parse(kDevices, "m.toml").Root().Child("devices"));
  devices.max_skew = 10.0;  // a busy computer is not the subject here
  SweepPlan plan = SmallPlan();
  plan.passes = 1;
  SteadyClock clock(2.0);
  const std::vector<ModbusSettings> probes_and_scale = SettingsOf<ModbusDevice>(devices);
  MovingBank bank(probes_and_scale, plan, clock);
  auto server = ModbusServer::ListenTcp("127.0.0.1", 0, bank);
  const int port = server->port();
  devices.devices.clear();
  for (ModbusSettings device : probes_and_scale) {
    device.port = port;
    devices.devices.push_back(std::make_shared<ModbusDevice>(device));
  }
  const OpenedDevices opened = OpenDevices(devices, clock, Presence::kRequired);

  const auto path =
      std::filesystem::temp_directory_path() / ("abbe_sweep_" + std::to_string(getpid()) + ".csv");
  std::filesystem::remove(path);
  const auto& channels = opened.source->channels();
  const auto writer = recording::Writer::Create(
      path, SweepHeader(plan, {"test", recording::UtcNow(), "modbus", ""}, channels),
      SweepColumns(channels));
  // Away from the middle of the second stand to the middle of the fourth.
  const auto& stands = bank.machine().stands();
  const double gone_s = 0.5 * (stands[1].from_s + stands[1].to_s);
  const double back_s = 0.5 * (stands[3].from_s + stands[3].to_s);
  std::jthread fate([&] {
    clock.SleepUntil(gone_s);
    server.reset();
    clock.SleepUntil(back_s);
    server = ModbusServer::ListenTcp("127.0.0.1", port, bank);
  });
  const SweepOutcome outcome = RecordSweep(*opened.source, plan, clock, *writer, {.rate = 100.0});
  fate.join();
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  EXPECT_GT(outcome.flagged, 0u);
  ASSERT_GE(outcome.lacking.size(), 1u);
  for (const Visit& visit : outcome.lacking) {
    EXPECT_TRUE(visit.station == 2 || (visit.station == 1 && visit.direction > 0));
  }

  const recording::Recording read = recording::Read(path);
  std::filesystem::remove(path);
  EXPECT_EQ(read.rows(), outcome.rows);
  EXPECT_EQ(read.HeaderText("axis").value_or(""), "X");
  const auto flags = read.At("flags"), probe = read.At("probe_c_um"), position = read.At("x_mm");
  bool is_back = false;
  for (std::size_t i = 0; i < read.rows(); ++i) {
    EXPECT_EQ(std::isnan(probe[i]) || std::isnan(position[i]), flags[i] != 0.0);
    // The server returns after the axis has turned back; from then on every row is good.
    is_back = is_back || (flags[i] == 0.0 && read.At("direction")[i] < 0);
    if (is_back) {
      EXPECT_EQ(flags[i], 0.0) << i;
    }
  }
  EXPECT_TRUE(is_back);
}

}  // namespace sweep_over_modbus_test
}  // namespace abbe::hal
