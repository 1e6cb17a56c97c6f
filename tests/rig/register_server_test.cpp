#include "rig/register_server.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "hal/modbus/modbus_client.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace register_server_test {

using hal::ModbusClient;
using hal::RegisterTable;

constexpr double kCount = 200e-6 / 65536.0;  // m, of the demonstration machine's amplifier

// The demonstration machine on a free port, with a clock that the test sets.
class Served {
 public:
  explicit Served(const RigSettings& settings, std::uint64_t seed = 7)
      : world(settings, seed),
        devices(hal::ReadDevices(DemoMill().Root().Child("devices"))),
        live(world, [this] { return now.load(); }),
        server(live, devices, {}),
        head(At(0)),
        machine(At(1)) {}

  hal::ModbusSettings At(std::size_t device) const {
    hal::ModbusSettings settings = hal::SettingsOf<hal::ModbusDevice>(devices)[device];
    settings.port = server.port();
    settings.times.response = 5.0;  // as long as a busy computer needs
    settings.times.deadline = 10.0;
    return settings;
  }

  std::vector<std::uint16_t> Read(ModbusClient& client, RegisterTable table, int address,
                                  int count) {
    std::vector<std::uint16_t> words(static_cast<std::size_t>(count));
    const auto fault = client.Read(table, address, words, client.Deadline());
    EXPECT_FALSE(fault) << fault->text;
    return words;
  }

  std::atomic<double> now{0.0};
  World world;
  hal::DevicesSettings devices;
  LiveMachine live;
  RegisterServer server;
  ModbusClient head, machine;
};

TEST(RegisterServer, ShowsTheWorldWithinOneCount) {
  Served rig(DemoRig());
  SensorNoise noise(DemoRig(), 7, 0);
  const Eigen::Vector3d rest = rig.world.settings().StartOf(0);
  for (const double time : {0.0, 0.0125, 3.0, 250.0}) {
    rig.now = time;
    const auto words = rig.Read(rig.head, RegisterTable::kInput, 0, 5);
    const Readings gaps = rig.world.ReadingsAt(0, rest);
    const auto tick = static_cast<std::uint64_t>(time * 1000.0);
    for (int probe = 0; probe < kProbes; ++probe) {
      const double expected =
          gaps[probe] + noise.OfProbe(probe, tick, 1e-3 * static_cast<double>(tick));
      EXPECT_NEAR(words[probe] * kCount, expected, 0.5 * kCount * (1 + 1e-9));
    }
  }
}

TEST(RegisterServer, SweepsWhenTheCycleIsStarted) {
  Served rig(DemoRig());
  const auto state = [&] { return rig.Read(rig.machine, RegisterTable::kHolding, 100, 2); };
  EXPECT_EQ(state(), (std::vector<std::uint16_t>{0, 0}));
  rig.now = 2.0;
  ASSERT_FALSE(rig.machine.Write(100, 3, rig.machine.Deadline()));
  EXPECT_EQ(state(), (std::vector<std::uint16_t>{3, 1}));

  const RigSettings& settings = rig.world.settings();
  const SweepMotion motion(*settings.sweeps[2], {settings.acceleration, settings.lag}, 0.0);
  const auto& stand = motion.standstills()[40];
  rig.now = 2.0 + stand.end - 0.01;
  const auto words = rig.Read(rig.machine, RegisterTable::kHolding, 0, 8);
  const auto scale = [&](std::size_t at) {
    return 1e-8 *
           static_cast<std::int32_t>(static_cast<std::uint32_t>(words[at]) << 16 | words[at + 1]);
  };
  EXPECT_NEAR(scale(4), settings.sweeps[2]->stations[stand.visit.station], 1e-8);
  EXPECT_EQ(scale(0), 0.0);
  EXPECT_EQ(scale(2), 0.0);
  EXPECT_NEAR(0.01 * words[6], 20.0, 1.0);  // ten times the temperature's drift

  // The head is the one installed for Z.
  const auto gap = rig.Read(rig.head, RegisterTable::kInput, 0, 1)[0] * kCount;
  const double expected = rig.world.ReadingsAt(2, {0.0, 0.0, scale(4)})[0];
  EXPECT_NEAR(gap, expected, 0.3e-6);  // ten standard deviations of the noise

  rig.now = 2.0 + motion.duration() + 0.001;
  EXPECT_EQ(state(), (std::vector<std::uint16_t>{0, 2}));
}

TEST(RegisterServer, RefusesASecondStartAndAnUnknownAxis) {
  Served rig(DemoRig());
  const auto start = [&](std::uint16_t axis) {
    const auto fault = rig.machine.Write(100, axis, rig.machine.Deadline());
    return fault ? fault->exception : 0;
  };
  EXPECT_EQ(start(4), 3);
  EXPECT_EQ(start(0), 3);
  EXPECT_EQ(start(1), 0);
  EXPECT_EQ(start(2), 6);  // busy
}

TEST(RegisterServer, RefusesRegistersThatItHasNot) {
  Served rig(DemoRig());
  std::vector<std::uint16_t> words(6);
  const auto beyond = rig.head.Read(RegisterTable::kInput, 0, words, rig.head.Deadline());
  ASSERT_TRUE(beyond);
  EXPECT_EQ(beyond->exception, 2);
  const auto other = rig.head.Read(RegisterTable::kHolding, 0, words, rig.head.Deadline());
  ASSERT_TRUE(other);
  EXPECT_EQ(other->exception, 2);
}

TEST(RegisterServer, ShowsAllOnesWhenAGapIsOutOfRange) {
  RigSettings settings = DemoRig();
  settings.gap_setting = 0.0;
  settings.probe_position = 120e-6;  // depths far beyond the range of some probes
  Served rig(settings);
  rig.now = 1.0;
  const auto words = rig.Read(rig.head, RegisterTable::kInput, 0, 5);
  const Readings gaps = rig.world.ReadingsAt(0, settings.StartOf(0));
  int outside = 0;
  for (int probe = 0; probe < kProbes; ++probe) {
    const bool out = gaps[probe] < 0.0 || gaps[probe] > 200e-6;
    outside += out ? 1 : 0;
    EXPECT_EQ(words[probe] == 65535, out) << gaps[probe];
  }
  EXPECT_GT(outside, 0);
  EXPECT_LT(outside, kProbes);
}

TEST(RegisterServer, RefusesAChannelThatTheRigHasNot) {
  const World world(DemoRig(), 1);
  LiveMachine machine(world, [] { return 0.0; });
  auto devices = hal::ReadDevices(DemoMill().Root().Child("devices"));
  hal::ModbusSettings head = hal::SettingsOf<hal::ModbusDevice>(devices)[0];
  head.blocks[0].channels[0].name = "force_n";
  devices.devices = {std::make_shared<hal::ModbusDevice>(head)};
  EXPECT_THROW(RegisterServer(machine, devices, {}), InputError);
}

TEST(RegisterServer, ServesADeviceOverRtu) {
  Served rig(DemoRig());
  hal::ModbusSettings device = rig.At(0);
  device.framing = hal::ModbusFraming::kRtu;
  device.serial = {rig.server.OpenRtu("head"), 115200, 'N', 1};
  device.times.wait = 0.005;
  ModbusClient serial(device);
  EXPECT_EQ(rig.Read(serial, RegisterTable::kInput, 0, 5),
            rig.Read(rig.head, RegisterTable::kInput, 0, 5));
  EXPECT_THROW(rig.server.OpenRtu("foot"), InputError);
}

TEST(RegisterServer, TellsItsMap) {
  Served rig(DemoRig());
  const std::string map = rig.server.MapText();
  EXPECT_NE(map.find("unit 1 input registers 0 to 4 (head): probe_a_um"), std::string::npos) << map;
  EXPECT_NE(map.find("unit 2 holding register 100"), std::string::npos) << map;
}

// An independent client: mbpoll prints "[1]: \t32768" for each register.
TEST(RegisterServer, IsReadByMbpoll) {
  if (std::system("command -v mbpoll >/dev/null 2>&1") != 0) GTEST_SKIP() << "mbpoll not found";
  Served rig(DemoRig());
  rig.now = 5.0;
  const std::string command = "mbpoll -m tcp -p " + std::to_string(rig.server.port()) +
                              " -a 1 -t 3 -0 -r 0 -c 5 -1 127.0.0.1";
  FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::vector<std::uint16_t> words;
  char line[256];
  while (fgets(line, sizeof line, pipe) != nullptr) {
    int address = 0, word = 0;
    if (std::sscanf(line, "[%d]: %d", &address, &word) == 2) {
      words.push_back(static_cast<std::uint16_t>(word));
    }
  }
  EXPECT_EQ(pclose(pipe), 0);
  EXPECT_EQ(words, rig.Read(rig.head, RegisterTable::kInput, 0, 5));
}

TEST(RegisterServer, SaysThatItIsSimulated) {
  Served rig(DemoRig());
  EXPECT_EQ(rig.head.Identity(rig.head.Deadline()), "abbe virtual rig (simulated)");
}

}  // namespace register_server_test
}  // namespace abbe::rig
