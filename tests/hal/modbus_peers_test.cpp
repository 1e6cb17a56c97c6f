// Programs that share nothing with abbe: a pymodbus server, the client mbpoll, and socat's serial
// line.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "../folders.h"
#include "child_process.h"
#include "hal/combined_source.h"
#include "hal/modbus/modbus_server.h"

namespace abbe::hal {
namespace modbus_peers_test {

constexpr char kPython[] = "/usr/bin/python3";  // Debian's, which sees Debian's pymodbus

DevicesSettings Devices(const std::string& text) {
  return ReadDevices(settings::Document::Parse(text, "peers.toml").Root().Child("devices"));
}

// Reads until every sample is good, for as long as a slow start may take.
SampleSet ReadWell(SampleSource& source) {
  SampleSet set = source.Read();
  for (int i = 0; i < 600 && !set.AllGood(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    set = source.Read();
  }
  return set;
}

TEST(ModbusPeers, ReadsEveryTypeAndOrderFromPymodbus) {
  if (!Succeeds(std::string(kPython) + " -c 'import pymodbus'")) {
    GTEST_SKIP() << "skipped: python3-pymodbus is not installed";
  }
  ChildProcess server({kPython, SourceFolder() / "tests/hal/pymodbus_server.py"});
  const std::string place = "host = '127.0.0.1'\nport = " + server.Line() + "\n";
  std::string channels;
  int at = 0;
  std::vector<double> expected;
  const std::vector<std::pair<std::string, double>> numbers = {
      {"int16", -12345.0},
      {"uint16", 54321.0},
      {"int32", -1234567890.0},
      {"uint32", 3456789012.0},
      {"float32", static_cast<double>(-1234.5678f)}};
  for (const auto& [type, number] : numbers) {
    for (const std::string order : {"ABCD", "CDAB", "BADC", "DCBA"}) {
      channels += "{name = '" + type + order + "', at = " + std::to_string(at) + ", type = '" +
                  type + "', order = '" + order + "', may_freeze = true},\n";
      at += type.substr(type.size() - 2) == "16" ? 1 : 2;
      expected.push_back(number);
    }
  }
  const DevicesSettings all = Devices(
      "[devices.a]\n" + place + "[[devices.a.block]]\naddress = 0\ncount = " + std::to_string(at) +
      "\nchannel = [\n" + channels + "]\n[devices.b]\nunit = 2\n" + place +
      "cycle_start = {function = 'holding', address = 4}\n"
      "[[devices.b.block]]\nfunction = 'holding'\naddress = 4\ncount = 2\nchannel = ["
      "{name = 'started', at = 0, type = 'int16', may_freeze = true},"
      "{name = 'temp_c', at = 1, type = 'int16', scale = 0.1, offset = -10, may_freeze = true}]\n");
  SteadyClock clock;
  const OpenedDevices opened = OpenDevices(all, clock, Presence::kAwaited);
  SampleSet set = ReadWell(*opened.source);
  ASSERT_TRUE(set.AllGood()) << opened.source->Fault();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(set.samples[i].value, expected[i]) << opened.source->channels()[i].name;
  }
  EXPECT_EQ(set.samples[expected.size()].value, 0.0);
  EXPECT_NEAR(set.samples[expected.size() + 1].value, 22.1, 1e-9);
  opened.start_cycle(2);
  set = ReadWell(*opened.source);
  EXPECT_EQ(set.samples[expected.size()].value, 2.0);
}

class MbpollTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Succeeds("mbpoll -V")) GTEST_SKIP() << "skipped: mbpoll is not installed";
    image_.Set(3, RegisterTable::kInput, 10, {1000, 0xFFFF, 0x4148, 0x0000});
    image_.Set(3, RegisterTable::kHolding, 100, {0});
  }
  static std::string Run(const std::vector<std::string>& command) {
    return ChildProcess(command).Rest();
  }

  RegisterImage image_;
};

TEST_F(MbpollTest, ReadsAndWritesOurTcpServer) {
  const auto server = ModbusServer::ListenTcp("127.0.0.1", 0, image_);
  const std::vector<std::string> place = {"-m", "tcp", "-p", std::to_string(server->port()),
                                          "-0", "-1",  "-a", "3"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> command = {"mbpoll"};
    command.insert(command.end(), place.begin(), place.end());
    command.insert(command.end(), more.begin(), more.end());
    return Run(command);
  };
  const std::string read = with({"-t", "3", "-r", "10", "-c", "2", "127.0.0.1"});
  EXPECT_NE(read.find("[10]: \t1000"), std::string::npos) << read;
  EXPECT_NE(read.find("[11]: \t65535 (-1)"), std::string::npos) << read;
  const std::string number = with({"-t", "3:float", "-B", "-r", "12", "127.0.0.1"});
  EXPECT_NE(number.find("[12]: \t12.5"), std::string::npos) << number;
  with({"-t", "4", "-r", "100", "127.0.0.1", "77"});
  EXPECT_EQ(image_.Get(3, RegisterTable::kHolding, 100), 77);
}

TEST_F(MbpollTest, ReadsOurSerialServerOnAPty) {
  const auto server = ModbusServer::OpenPty(3, image_);
  const std::string read = Run({"mbpoll", "-m", "rtu", "-b", "115200", "-P", "none", "-0", "-1",
                                "-a", "3", "-t", "3", "-r", "10", "-c", "2", server->device()});
  EXPECT_NE(read.find("[10]: \t1000"), std::string::npos) << read;
}

class SocatTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Succeeds("socat -V")) GTEST_SKIP() << "skipped: socat is not installed";
    folder_ = std::filesystem::temp_directory_path() / ("abbe_socat_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    Connect();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // A serial line between the devices near() and far().
  void Connect() {
    std::filesystem::remove(near());
    std::filesystem::remove(far());
    line_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{"socat", "pty,raw,echo=0,link=" + near().string(),
                                 "pty,raw,echo=0,link=" + far().string()});
    for (int i = 0; i < 600 && !(std::filesystem::exists(near()) && std::filesystem::exists(far()));
         ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  std::filesystem::path near() const { return folder_ / "near"; }
  std::filesystem::path far() const { return folder_ / "far"; }

  std::filesystem::path folder_;
  std::unique_ptr<ChildProcess> line_;
};

TEST_F(SocatTest, ReadsOverASerialLineAndSurvivesItsHangUp) {
  RegisterImage image;
  image.Set(5, RegisterTable::kInput, 0, {100, 200, 300});
  const auto serve = [&] {
    return ModbusServer::OpenSerial({far().string(), 115200, 'N', 1}, 5, image);
  };
  auto server = serve();
  const DevicesSettings all = Devices(
      "[devices.a]\ntransport = 'modbus-rtu'\nunit = 5\nbackoff_first_ms = 20\nbackoff_most_ms = "
      "20\n"
      "serial = {device = '" +
      near().string() +
      "', baud = 115200, parity = 'none'}\n"
      "[[devices.a.block]]\naddress = 0\ncount = 3\nchannel = ["
      "{name = 'probe_a_um', at = 2, type = 'uint16', scale = 0.5, may_freeze = true}]\n");
  SteadyClock clock;
  const OpenedDevices opened = OpenDevices(all, clock, Presence::kAwaited);
  const SampleSet set = ReadWell(*opened.source);
  ASSERT_TRUE(set.AllGood()) << opened.source->Fault();
  EXPECT_EQ(set.samples[0].value, 150.0);

  line_->Kill();
  const Sample lost = opened.source->Read().samples[0];
  EXPECT_EQ(lost.cause, Cause::kNoReply);
  EXPECT_TRUE(std::isnan(lost.value));
  server.reset();
  Connect();
  server = serve();
  EXPECT_TRUE(ReadWell(*opened.source).AllGood()) << opened.source->Fault();
}

}  // namespace modbus_peers_test
}  // namespace abbe::hal
