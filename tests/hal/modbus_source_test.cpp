// A Modbus device over real sockets and a pseudo terminal: the contract, the messages, the
// recovery.
#include "hal/modbus/modbus_source.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "hal/combined_source.h"
#include "hal/modbus/modbus_device.h"
#include "hal/modbus/modbus_server.h"
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

ModbusSettings TwoProbes() {
  ModbusSettings device;
  device.name = "head";
  device.host = "127.0.0.1";
  device.times.backoff_first = device.times.backoff_most = 1e-3;
  BlockSettings block;
  block.count = 2;
  block.channels = ContractChannels();
  device.blocks = {block};
  return device;
}

DevicesSettings Only(const ModbusSettings& device) {
  DevicesSettings devices;
  devices.devices = {std::make_shared<ModbusDevice>(device)};
  return devices;
}

class ModbusRig : public ContractRig {
 public:
  ModbusRig(Trouble trouble, ModbusFraming framing) : bank_(trouble) {
    ModbusSettings device = TwoProbes();
    device.framing = framing;
    // A lost reply is waited for; every other one may take as long as a busy computer needs.
    device.times.response = trouble == Trouble::kLost ? kLostReply : 2.0;
    device.times.deadline = 5.0;
    if (framing == ModbusFraming::kTcp) {
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
  static constexpr double kLostReply = 0.4;  // s

  TroubledBank bank_;
  HandClock clock_;
  std::unique_ptr<ModbusServer> server_;
  std::unique_ptr<ModbusSource> source_;
};

std::vector<ContractCase> Cases() {
  std::vector<ContractCase> cases;
  const auto add = [&](const std::string& name, Trouble trouble, Cause cause, bool fault) {
    for (const auto& [prefix, framing] :
         {std::pair{"Tcp", ModbusFraming::kTcp}, std::pair{"Rtu", ModbusFraming::kRtu}}) {
      cases.push_back(
          {prefix + name,
           [trouble, way = framing] { return std::make_unique<ModbusRig>(trouble, way); },
           // A computer that is too busy to look does not know whether a reply was lost.
           {cause, trouble == Trouble::kLost ? Cause::kClockJump : cause},
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
  ModbusSettings device_;
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
  device_.unit = 9;
  try {
    OpenDevices(Only(device_), clock_, Presence::kRequired);
    FAIL() << "opened";
  } catch (const DeviceError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "device \"head\" (127.0.0.1 port " + std::to_string(port_) +
            ", unit 9): exception 11 (gateway target does not answer) to: read 2 input "
            "registers from 0; its gateway does not reach it: check `unit`, that it is on, and "
            "the line behind the gateway");
  }
  device_.unit = 1;
  server_.reset();
  EXPECT_THROW(OpenDevices(Only(device_), clock_, Presence::kRequired), DeviceError);
  const OpenedDevices awaited = OpenDevices(Only(device_), clock_, Presence::kAwaited);
  EXPECT_EQ(ReadFrom(*awaited.source).samples[0].cause, Cause::kNoReply);
}

TEST_F(ModbusSourceTest, StartsTheCycleWithTheNumberOfTheAxis) {
  EXPECT_FALSE(OpenDevices(Only(device_), clock_, Presence::kRequired).start_cycle);
  device_.cycle_start = CycleStart{50};
  OpenDevices(Only(device_), clock_, Presence::kRequired).start_cycle(3);
  EXPECT_EQ(image_.Get(1, RegisterTable::kHolding, 50), 3);
  device_.cycle_start = CycleStart{51};
  EXPECT_THROW(OpenDevices(Only(device_), clock_, Presence::kRequired).start_cycle(1), DeviceError);
}

// Refuses with an exception a few times, then answers; takes what is written with "acknowledge".
class BusyBank : public RegisterBank {
 public:
  Answer Read(int, RegisterTable, int, std::span<std::uint16_t> words) override {
    if (refusals-- > 0) return refusal;
    for (std::uint16_t& word : words) word = static_cast<std::uint16_t>(++count_);
    return Answer::kOk;
  }
  Answer Write(int, int, std::span<const std::uint16_t>) override { return refusal; }
  std::vector<std::string> Identity(int) override { return {"Maker", "Converter 8", "2.1"}; }

  std::atomic<Answer> refusal{Answer::kBusy};
  std::atomic<int> refusals{0};

 private:
  int count_ = 0;
};

class BusyDevice : public testing::Test {
 protected:
  BusyDevice() : server_(ModbusServer::ListenTcp("127.0.0.1", 0, bank_)) {
    device_ = TwoProbes();
    device_.port = server_->port();
    device_.times.response = 2.0;
    device_.times.deadline = 5.0;
    device_.cycle_start = CycleStart{100};
  }
  BusyBank bank_;
  std::unique_ptr<ModbusServer> server_;
  ModbusSettings device_;
  HandClock clock_;
};

TEST_F(BusyDevice, IsAskedAgainAndKeepsItsLink) {
  for (const Answer refusal : {Answer::kAcknowledge, Answer::kBusy}) {
    bank_.refusal = refusal;
    bank_.refusals = 3;
    ModbusSource source(device_, 1.0, clock_);
    source.Require();
    EXPECT_EQ(source.Fault(), "");
    EXPECT_EQ(source.connections(), 1u);
    EXPECT_EQ(source.Description(), "modbus, Maker Converter 8 2.1");
    // While a recording goes on a refusal costs the reading and nothing else.
    bank_.refusals = 1;
    clock_.Advance(0.1);
    EXPECT_EQ(source.Read().samples[0].cause, Cause::kRefused);
    clock_.Advance(0.1);
    EXPECT_TRUE(source.Read().AllGood());
    EXPECT_EQ(source.connections(), 1u);
  }
}

TEST_F(BusyDevice, IsSaidToBeBusyAndNotToBeOff) {
  bank_.refusals = 1'000'000;
  ModbusSource source(device_, 1.0, clock_);
  try {
    source.Require();
    FAIL() << "taken";
  } catch (const DeviceError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("exception 6 (busy)"), std::string::npos) << text;
    EXPECT_NE(text.find("try again when it is done"), std::string::npos) << text;
    EXPECT_EQ(text.find("check that it is on"), std::string::npos) << text;
  }
}

TEST_F(BusyDevice, ThatAcknowledgesAStartHasTakenIt) {
  ModbusSource source(device_, 1.0, clock_);
  EXPECT_THROW(source.StartCycle(1), DeviceError);
  bank_.refusal = Answer::kAcknowledge;
  EXPECT_NO_THROW(source.StartCycle(1));
}

TEST_F(BusyDevice, IsNamedInTheHeader) {
  const OpenedDevices opened = OpenDevices(Only(device_), clock_, Presence::kRequired);
  EXPECT_EQ(opened.transport.at("head"), "modbus, Maker Converter 8 2.1");
}

// The time within which a reading was made is that of its exchange, also with one device alone.
TEST_F(ModbusSourceTest, AReadingIsKnownToWithinItsExchange) {
  class SlowBank : public RegisterImage {
   public:
    explicit SlowBank(HandClock& clock) : clock_(clock) {}
    Answer Read(int unit, RegisterTable table, int address,
                std::span<std::uint16_t> words) override {
      clock_.Advance(0.3);  // no other thread looks at it meanwhile
      return RegisterImage::Read(unit, table, address, words);
    }

   private:
    HandClock& clock_;
  };
  SlowBank bank(clock_);
  bank.Set(1, RegisterTable::kInput, 0, {100, 200});
  const auto server = ModbusServer::ListenTcp("127.0.0.1", 0, bank);
  device_.port = server->port();
  DevicesSettings all = Only(device_);
  all.max_skew = 0.4;
  {
    const OpenedDevices opened = OpenDevices(all, clock_, Presence::kAwaited);
    const double start = clock_.Now();
    const SampleSet set = opened.source->Read();
    EXPECT_TRUE(set.AllGood());
    EXPECT_NEAR(set.skew_s, 0.3, 1e-12);
    EXPECT_NEAR(set.samples[0].time_s, start + 0.15, 1e-12);
    EXPECT_NEAR(set.samples[0].within_s, 0.15, 1e-12);
  }
  all.max_skew = 0.2;
  const OpenedDevices opened = OpenDevices(all, clock_, Presence::kAwaited);
  EXPECT_EQ(opened.source->Read().samples[0].cause, Cause::kIncoherent);
}

TEST_F(ModbusSourceTest, TwoUnitsOfOneServerAreOneCoherentSet) {
  image_.Set(2, RegisterTable::kInput, 0, {7, 8});
  ModbusSettings machine = device_;
  machine.name = "machine";
  machine.unit = 2;
  machine.blocks[0].channels[0].name = "x_mm";
  machine.blocks[0].channels[1].name = "y_mm";
  DevicesSettings all = Only(device_);
  all.devices.push_back(std::make_shared<ModbusDevice>(machine));
  all.max_skew = 1e9;
  const OpenedDevices opened = OpenDevices(all, clock_, Presence::kRequired);
  const SampleSet set = ReadFrom(*opened.source);
  ASSERT_EQ(set.samples.size(), 4u);
  EXPECT_TRUE(set.AllGood());
  EXPECT_DOUBLE_EQ(set.samples[3].value, 8 * kStep);
  EXPECT_EQ(opened.source->channels()[2].device, "machine");
}

// A connection of raw bytes.
class RawLink {
 public:
  explicit RawLink(int port) : end_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connect(end_, reinterpret_cast<sockaddr*>(&address), sizeof address);
  }
  ~RawLink() { close(end_); }
  RawLink(const RawLink&) = delete;
  void Send(const std::vector<std::uint8_t>& bytes) const {
    send(end_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  // What comes, up to `count` bytes; less when the link is closed.
  std::vector<std::uint8_t> Take(std::size_t count) const {
    std::vector<std::uint8_t> bytes(count);
    const ssize_t size = recv(end_, bytes.data(), count, MSG_WAITALL);
    bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return bytes;
  }

 private:
  int end_;
};

// The half is answered once it is whole; a server that had waited for it would have given it up
// before it answered the other client.
TEST(ModbusServer, AHalfRequestHoldsUpNobody) {
  RegisterImage image;
  image.Set(1, RegisterTable::kInput, 0, {1, 2});
  const auto server = ModbusServer::ListenTcp("127.0.0.1", 0, image);
  ModbusSettings device = TwoProbes();
  device.port = server->port();
  bool answered = false;
  for (int attempt = 0; attempt < 10 && !answered; ++attempt) {  // a busy computer may take 0.5 s
    const RawLink half(server->port());
    half.Send({0, 9, 0, 0, 0, 6, 1});
    std::array<std::uint16_t, 2> words{};
    ModbusClient client(device);
    if (client.Read(RegisterTable::kInput, 0, words, client.Deadline())) continue;
    half.Send({4, 0, 0, 0, 2});
    answered = half.Take(13) == std::vector<std::uint8_t>{0, 9, 0, 0, 0, 7, 1, 4, 4, 0, 1, 0, 2};
  }
  EXPECT_TRUE(answered);
  // One that stays a half is given up.
  const RawLink half(server->port());
  half.Send({0, 9, 0});
  EXPECT_TRUE(half.Take(1).empty());
}

TEST(ModbusServer, ServesSeveralClientsAndGivesItsPlaceAway) {
  RegisterImage image;
  image.Set(1, RegisterTable::kInput, 0, {1, 2});
  const auto server = ModbusServer::ListenTcp("127.0.0.1", 0, image);
  ModbusSettings device = TwoProbes();
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
