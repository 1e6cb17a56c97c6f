// A Modbus device over real sockets and a pseudo terminal: the contract, the messages, the
// recovery.
#include "hal/modbus_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "hal/combined_source.h"
#include "hal/modbus_server.h"
#include "sample_source_contract.h"

namespace abbe::hal {
namespace modbus_source_test {

// Unit 1, input registers 0 and 1: the contract's truth, with the trouble in its place.
class TroubledBank : public RegisterBank {
 public:
  explicit TroubledBank(Trouble trouble) : trouble_(trouble) {}
  void Tick(int tick) { tick_ = tick; }

  Answer Read(int, RegisterTable, int address, std::span<std::uint16_t> words) override {
    const int tick = tick_;
    const bool trouble = tick >= kTroubleFrom && tick < kTroubleTo;
    if (trouble && trouble_ == Trouble::kLost) return Answer::kSilence;
    if (trouble && trouble_ == Trouble::kRefused) return Answer::kDeviceFailure;
    for (std::size_t i = 0; i < words.size(); ++i) {
      words[i] = TrueWord(static_cast<std::size_t>(address) + i, tick);
      if (trouble && trouble_ == Trouble::kSaturated) words[i] = 65000;
      if (trouble && trouble_ == Trouble::kSentinel) words[i] = 65535;
    }
    return Answer::kOk;
  }

 private:
  Trouble trouble_;
  std::atomic<int> tick_{0};
};

DeviceSettings TwoProbes() {
  DeviceSettings device;
  device.name = "head";
  device.host = "127.0.0.1";
  device.times.backoff_first = device.times.backoff_most = 1e-3;
  BlockSettings block;
  block.count = 2;
  block.channels = ContractChannels();
  device.blocks = {block};
  return device;
}

class ModbusRig : public ContractRig {
 public:
  ModbusRig(Trouble trouble, Transport transport) : bank_(trouble) {
    DeviceSettings device = TwoProbes();
    device.transport = transport;
    // A lost reply is waited for; every other one may take as long as a busy computer needs.
    device.times.response = trouble == Trouble::kLost ? kLostReply : 2.0;
    device.times.deadline = 5.0;
    if (transport == Transport::kModbusTcp) {
      server_ = ModbusServer::ListenTcp("127.0.0.1", 0, bank_);
      device.port = server_->port();
    } else {
      server_ = ModbusServer::OpenPty(1, bank_);
      device.serial = {server_->device(), 115200, 'N', 1};
    }
    source_ = std::make_unique<ModbusSource>(device, kStale, clock_);
  }
  SampleSource& source() override { return *source_; }
  Clock& clock() override { return clock_; }
  void Tick(int tick) override {
    bank_.Tick(tick);
    clock_.Advance(kTick);
    if (tick < kTroubleTo || tick >= kTroubleTo + 2) return;
    // The back-off is real time, on a serial line as long as a reply may take.
    std::this_thread::sleep_for(std::chrono::duration<double>(2.0 * kLostReply));
  }

 private:
  static constexpr double kLostReply = 0.15;  // s

  TroubledBank bank_;
  HandClock clock_;
  std::unique_ptr<ModbusServer> server_;
  std::unique_ptr<ModbusSource> source_;
};

std::vector<ContractCase> Cases() {
  std::vector<ContractCase> cases;
  const auto add = [&](const std::string& name, Trouble trouble, Cause cause, bool fault) {
    for (const auto& [prefix, transport] :
         {std::pair{"Tcp", Transport::kModbusTcp}, std::pair{"Rtu", Transport::kModbusRtu}}) {
      cases.push_back({prefix + name,
                       [=, way = transport] { return std::make_unique<ModbusRig>(trouble, way); },
                       {cause},
                       true,
                       fault,
                       trouble == Trouble::kLost ? 3 : 0});
    }
  };
  add("Lost", Trouble::kLost, Cause::kNoReply, true);
  add("Refused", Trouble::kRefused, Cause::kRefused, true);
  add("Saturated", Trouble::kSaturated, Cause::kOutOfRange, false);
  add("Sentinel", Trouble::kSentinel, Cause::kSentinel, false);
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Modbus, SampleSourceContract, testing::ValuesIn(Cases()), CaseName);

class ModbusSourceTest : public testing::Test {
 protected:
  ModbusSourceTest() {
    image_.Set(1, RegisterTable::kInput, 0, {100, 200});
    image_.Set(1, RegisterTable::kHolding, 50, {0});
    Listen(0);
    device_ = TwoProbes();
    device_.port = port_;
    device_.times.response = 2.0;
    device_.times.deadline = 5.0;
  }
  void Listen(int port) {
    server_ = ModbusServer::ListenTcp("127.0.0.1", port, image_);
    port_ = server_->port();
  }
  SampleSet ReadFrom(SampleSource& source) {
    clock_.Advance(0.01);
    return source.Read();
  }

  RegisterImage image_;
  std::unique_ptr<ModbusServer> server_;
  int port_ = 0;
  DeviceSettings device_;
  HandClock clock_;
  std::vector<std::string> log_;
};

TEST_F(ModbusSourceTest, AFrozenRegisterIsBadUntilItMoves) {
  ModbusSource source(device_, 1.0, clock_);
  EXPECT_TRUE(ReadFrom(source).AllGood());
  clock_.Advance(0.9);
  EXPECT_TRUE(ReadFrom(source).AllGood());
  clock_.Advance(0.2);
  image_.Set(1, RegisterTable::kInput, 1, {201});
  const SampleSet set = ReadFrom(source);
  EXPECT_EQ(set.samples[0].cause, Cause::kFrozen);
  EXPECT_TRUE(set.samples[1].good());
  image_.Set(1, RegisterTable::kInput, 0, {101});
  EXPECT_TRUE(ReadFrom(source).AllGood());
}

TEST_F(ModbusSourceTest, AServerThatVanishesAndReturnsIsLoggedOncePerChange) {
  ModbusSource source(device_, 1.0, clock_,
                      [this](const std::string& line) { log_.push_back(line); });
  EXPECT_TRUE(ReadFrom(source).AllGood());
  server_.reset();
  for (int i = 0; i < 10; ++i) {
    const SampleSet set = ReadFrom(source);
    EXPECT_EQ(set.samples[0].cause, Cause::kNoReply);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  EXPECT_EQ(source.failures(), 10u);
  Listen(port_);
  bool well = false;
  for (int i = 0; i < 1000 && !well; ++i) {
    well = ReadFrom(source).AllGood();
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  EXPECT_TRUE(well);
  ASSERT_EQ(log_.size(), 2u);
  EXPECT_EQ(log_[0].substr(0, log_[0].find(": the link broke")),
            "device \"head\" (127.0.0.1 port " + std::to_string(port_) + ", unit 1)");
  EXPECT_NE(log_[1].find("answers again after "), std::string::npos);
}

TEST_F(ModbusSourceTest, ARefusedBlockLeavesTheOthersGood) {
  BlockSettings missing = device_.blocks[0];
  missing.address = 900;
  device_.blocks.insert(device_.blocks.begin(), missing);
  ModbusSource source(device_, 1.0, clock_);
  const SampleSet set = ReadFrom(source);
  EXPECT_EQ(set.samples[0].cause, Cause::kRefused);
  EXPECT_TRUE(set.samples[2].good());
  EXPECT_EQ(
      source.Fault(),
      "device \"head\": exception 2 (illegal data address) to: read 2 input registers from 900");
  EXPECT_EQ(source.connections(), 1u);
}

TEST_F(ModbusSourceTest, AStatusRegisterInAnotherBlockDecides) {
  image_.Set(1, RegisterTable::kInput, 60, {0, 3});
  BlockSettings status;
  status.address = 60;
  status.count = 2;
  device_.blocks.push_back(status);
  device_.blocks[0].channels[0].status = StatusRule{60, RegisterTable::kInput, 0xFFFF, {0}};
  device_.blocks[0].channels[1].status = StatusRule{61, RegisterTable::kInput, 0xFFFF, {0}};
  ModbusSource source(device_, 1.0, clock_);
  const SampleSet set = ReadFrom(source);
  EXPECT_TRUE(set.samples[0].good());
  EXPECT_EQ(set.samples[1].cause, Cause::kSensorFault);
}

TEST_F(ModbusSourceTest, OpeningSaysWhichDeviceWhatItAnsweredAndWhatWasTried) {
  DevicesSettings all;
  all.devices = {device_};
  all.devices[0].unit = 9;
  try {
    OpenDevices(all, clock_, Presence::kRequired);
    FAIL() << "opened";
  } catch (const DeviceError& error) {
    EXPECT_EQ(std::string(error.what()),
              "device \"head\" (127.0.0.1 port " + std::to_string(port_) +
                  ", unit 9): exception 11 (gateway target does not answer) to: read 2 input "
                  "registers from 0; check that it is on, the link, and its place and unit in the "
                  "machine file");
  }
  all.devices[0].unit = 1;
  server_.reset();
  EXPECT_THROW(OpenDevices(all, clock_, Presence::kRequired), DeviceError);
  const OpenedDevices awaited = OpenDevices(all, clock_, Presence::kAwaited);
  EXPECT_EQ(ReadFrom(*awaited.source).samples[0].cause, Cause::kNoReply);
}

TEST_F(ModbusSourceTest, StartsTheCycleWithTheNumberOfTheAxis) {
  DevicesSettings all;
  all.devices = {device_};
  EXPECT_FALSE(OpenDevices(all, clock_, Presence::kRequired).start_cycle);
  all.devices[0].cycle_start = CycleStart{50};
  OpenDevices(all, clock_, Presence::kRequired).start_cycle(3);
  EXPECT_EQ(image_.Get(1, RegisterTable::kHolding, 50), 3);
  all.devices[0].cycle_start = CycleStart{51};
  EXPECT_THROW(OpenDevices(all, clock_, Presence::kRequired).start_cycle(1), DeviceError);
}

TEST_F(ModbusSourceTest, TwoUnitsOfOneServerAreOneCoherentSet) {
  image_.Set(2, RegisterTable::kInput, 0, {7, 8});
  DevicesSettings all;
  all.max_skew = 1e9;
  all.devices = {device_, device_};
  all.devices[1].name = "machine";
  all.devices[1].unit = 2;
  all.devices[1].blocks[0].channels[0].name = "x_mm";
  all.devices[1].blocks[0].channels[1].name = "y_mm";
  const OpenedDevices opened = OpenDevices(all, clock_, Presence::kRequired);
  const SampleSet set = ReadFrom(*opened.source);
  ASSERT_EQ(set.samples.size(), 4u);
  EXPECT_TRUE(set.AllGood());
  EXPECT_DOUBLE_EQ(set.samples[3].value, 8 * kStep);
  EXPECT_EQ(opened.source->channels()[2].device, "machine");
}

TEST(ModbusServer, ServesSeveralClientsAndGivesItsPlaceAway) {
  RegisterImage image;
  image.Set(1, RegisterTable::kInput, 0, {1, 2});
  const auto server = ModbusServer::ListenTcp("127.0.0.1", 0, image);
  DeviceSettings device = TwoProbes();
  device.port = server->port();
  device.times.response = device.times.deadline = 5.0;
  std::vector<std::unique_ptr<ModbusClient>> clients;
  clients.reserve(10);
  for (int i = 0; i < 10; ++i) clients.push_back(std::make_unique<ModbusClient>(device));
  for (int round = 0; round < 3; ++round) {
    for (const auto& client : clients) {
      std::array<std::uint16_t, 2> words{};
      EXPECT_FALSE(client->Read(RegisterTable::kInput, 0, words, client->Deadline()));
      EXPECT_EQ(words[1], 2);
    }
  }
  EXPECT_EQ(server->requests(), 30u);
  try {
    ModbusServer::ListenTcp("127.0.0.1", server->port(), image);
    FAIL() << "two servers on one port";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("Address already in use; take another port"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace modbus_source_test
}  // namespace abbe::hal
