// Every row of the fault table of the design: what the client says, whether the link is kept, and
// that it recovers without help. Time is bounded by the test's own limit, never asserted tightly; a
// computer that was too busy to look while a reply was due (kSuspended) has not shown the fault,
// and it is tried again.
#include "hal/modbus/modbus_client.h"

#include <gtest/gtest.h>

#include <array>

#include "hal/modbus/modbus_server.h"
#include "scripted_modbus_server.h"

namespace abbe::hal {
namespace modbus_client_test {

using Kind = ModbusFault::Kind;

ModbusSettings Device(int port) {
  ModbusSettings device;
  device.name = "head";
  device.host = "127.0.0.1";
  device.port = port;
  device.times.response = 2.0;  // as long as a busy computer needs
  device.times.byte = 2.0;
  device.times.deadline = 10.0;
  device.times.backoff_first = 0.01;
  device.times.backoff_most = 0.02;
  return device;
}

std::optional<ModbusFault> Read(ModbusClient& client, std::array<std::uint16_t, 5>& words) {
  return client.Read(RegisterTable::kInput, 7, words, client.Deadline());
}

// Reads until the client answers again (the back-off is 20 ms at most); false after 2 s.
bool Recovers(ModbusClient& client) {
  for (int i = 0; i < 400; ++i) {
    std::array<std::uint16_t, 5> words{};
    if (!Read(client, words)) {
      return words == std::array<std::uint16_t, 5>{1007, 1008, 1009, 1010, 1011};
    }
    poll(nullptr, 0, 5);
  }
  return false;
}

struct Row {
  const char* name;
  Misdeed misdeed;
  Kind kind;
  const char* says;  // the start of the fault's text
  bool keeps_link;
};

class ModbusClientFault : public testing::TestWithParam<Row> {
 protected:
  bool Shown();  // false: the computer was too busy to show it
};

TEST_P(ModbusClientFault, IsNamedAndRecoveredFrom) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    if (Shown()) return;
  }
  FAIL() << "the computer was too busy twenty times";
}

bool ModbusClientFault::Shown() {
  const Row& row = GetParam();
  ScriptedModbusServer server({Misdeed::kNone, row.misdeed});
  ModbusSettings device = Device(server.port());
  const bool waited_for = row.kind == Kind::kTimeout;
  if (waited_for) {
    device.times.response = 0.2;
    device.times.byte = 0.1;
    device.times.deadline = 1.0;
  }
  ModbusClient client(device);
  std::array<std::uint16_t, 5> words{};
  if (Read(client, words)) return false;
  words = {1, 2, 3, 4, 5};
  const auto fault = Read(client, words);
  if (fault && fault->kind == Kind::kSuspended) return false;
  EXPECT_TRUE(fault.has_value());
  if (!fault) return true;
  EXPECT_EQ(fault->kind, row.kind);
  EXPECT_EQ(fault->text.substr(0, std::string(row.says).size()), row.says);
  EXPECT_NE(fault->text.find("read 5 input registers from 7"), std::string::npos) << fault->text;
  EXPECT_EQ(words, (std::array<std::uint16_t, 5>{1, 2, 3, 4, 5}));
  EXPECT_EQ(client.connected(), row.keeps_link);
  EXPECT_TRUE(Recovers(client));
  const std::uint64_t connections = client.connections();
  EXPECT_EQ(connections > 1u, !row.keeps_link);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(Recovers(client));  // and stays well
  if (!waited_for) {
    EXPECT_EQ(client.connections(), connections);
  }
  return true;
}

INSTANTIATE_TEST_SUITE_P(
    Table, ModbusClientFault,
    testing::Values(
        Row{"Late", Misdeed::kLate, Kind::kTimeout, "no answer within ", false},
        Row{"Silent", Misdeed::kSilent, Kind::kTimeout, "no answer within ", false},
        Row{"Truncated", Misdeed::kTruncated, Kind::kTimeout, "only 9 of 19 bytes within", false},
        Row{"WrongTransaction", Misdeed::kWrongTransaction, Kind::kBadReply,
            "a reply to another request", false},
        Row{"WrongProtocol", Misdeed::kWrongProtocol, Kind::kBadReply, "bytes that are not Modbus",
            false},
        Row{"WrongFunction", Misdeed::kWrongFunction, Kind::kBadReply,
            "a reply to function 3 instead of 4", false},
        Row{"TooFewRegisters", Misdeed::kTooFewRegisters, Kind::kBadReply,
            "8 bytes of registers instead of 10", false},
        Row{"WrongUnit", Misdeed::kWrongUnit, Kind::kBadReply, "a reply from unit 2 instead of 1",
            false},
        Row{"Exception4", Misdeed::kException4, Kind::kException, "exception 4 (device failure)",
            true},
        Row{"Exception6", Misdeed::kException6, Kind::kException, "exception 6 (busy)", true},
        Row{"Reset", Misdeed::kReset, Kind::kNoLink, "the link broke (Connection reset by peer)",
            false},
        Row{"Close", Misdeed::kClose, Kind::kNoLink, "the link broke (closed by the device)",
            false},
        Row{"Garbage", Misdeed::kGarbage, Kind::kTimeout, "only 40 of 260 bytes within", false}),
    [](const auto& test) { return test.param.name; });

TEST(ModbusClient, TakesAReplyThatDripsInWithinTheDeadline) {
  ScriptedModbusServer server({Misdeed::kDrip});
  ModbusClient client(Device(server.port()));
  EXPECT_TRUE(Recovers(client));
  EXPECT_EQ(client.connections(), 1u);
}

TEST(ModbusClient, GivesUpAReplyThatDripsPastTheDeadline) {
  ScriptedModbusServer server({Misdeed::kDrip});  // 19 bytes in 380 ms
  ModbusSettings device = Device(server.port());
  device.times.deadline = 0.25;
  ModbusClient client(device);
  std::array<std::uint16_t, 5> words{};
  const auto fault = Read(client, words);
  ASSERT_TRUE(fault.has_value());
  if (fault->kind == Kind::kSuspended) return;  // too busy to look: no better
  EXPECT_EQ(fault->kind, Kind::kTimeout);
  EXPECT_EQ(fault->text.substr(0, 5), "only ");
}

TEST(ModbusClient, TakesADoubledReplyOnce) {
  ScriptedModbusServer server({Misdeed::kTwice, Misdeed::kTwice});
  ModbusClient client(Device(server.port()));
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(Recovers(client));
  EXPECT_EQ(client.connections(), 1u);
}

TEST(ModbusClient, NeverTakesADoubledReplyForTheNextOne) {
  ScriptedModbusServer server({Misdeed::kTwiceApart});
  ModbusClient client(Device(server.port()));
  std::array<std::uint16_t, 5> words{};
  ASSERT_FALSE(Read(client, words));
  // The repetition arrives at any time during these; each result must be its own registers.
  for (int i = 0; i < 200; ++i) {
    std::array<std::uint16_t, 1> word{};
    const int address = 100 + i;
    if (client.Read(RegisterTable::kInput, address, word, client.Deadline())) continue;
    EXPECT_EQ(word[0], 1000 + address);
  }
  EXPECT_TRUE(Recovers(client));
}

TEST(ModbusClient, APortWhereNobodyListensIsNamedAndBackedOffFrom) {
  int port = 0;
  {
    const ScriptedModbusServer gone({});
    port = gone.port();
  }
  ModbusSettings device = Device(port);
  device.times.backoff_first = device.times.backoff_most = 60.0;
  ModbusClient client(device);
  std::array<std::uint16_t, 5> words{};
  EXPECT_EQ(Read(client, words)->text, "cannot connect: Connection refused");
  EXPECT_EQ(Read(client, words)->text, "cannot connect: Connection refused");
  // Now the back-off runs: the next calls do not try (a try would count as a connection).
  const auto fault = Read(client, words);
  ASSERT_TRUE(fault.has_value());
  EXPECT_EQ(fault->kind, Kind::kNoLink);
  EXPECT_EQ(client.connections(), 0u);
}

// Serial replies carry no number. The first answer comes 200 ms after the client has given up.
class LateOnceBank : public RegisterBank {
 public:
  Answer Read(int, RegisterTable, int, std::span<std::uint16_t> words) override {
    words[0] = static_cast<std::uint16_t>(++asked_);
    if (asked_ == 1) poll(nullptr, 0, 600);
    return Answer::kOk;
  }
  int asked() const { return asked_; }

 private:
  std::atomic<int> asked_{0};
};

TEST(ModbusClient, ALateSerialReplyIsNeverTakenForTheNextOne) {
  LateOnceBank bank;
  const auto server = ModbusServer::OpenPty(1, bank);
  ModbusSettings device = Device(0);
  device.framing = ModbusFraming::kRtu;
  device.serial = {server->device(), 115200, 'N', 1};
  device.times.response = 0.4;
  ModbusClient client(device);
  std::array<std::uint16_t, 1> word{};
  const auto late = client.Read(RegisterTable::kInput, 0, word, client.Deadline());
  ASSERT_TRUE(late.has_value());
  EXPECT_TRUE(late->kind == Kind::kTimeout || late->kind == Kind::kSuspended) << late->text;
  int good = 0;
  for (int i = 0; i < 1000 && good < 5; ++i) {
    poll(nullptr, 0, 5);
    if (client.Read(RegisterTable::kInput, 0, word, client.Deadline())) continue;
    EXPECT_EQ(word[0], bank.asked());
    ++good;
  }
  EXPECT_EQ(good, 5);
}

TEST(ModbusClient, AHostThatDoesNotExistIsADeviceError) {
  ModbusSettings device = Device(502);
  device.host = "no-such-host.invalid";
  try {
    const ModbusClient client(device);
    FAIL() << "accepted";
  } catch (const DeviceError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 62),
              "device \"head\": the host \"no-such-host.invalid\" cannot be found");
  }
}

TEST(ModbusClient, TakesAHostName) {
  ScriptedModbusServer server({});
  ModbusSettings device = Device(server.port());
  device.host = "localhost";
  try {
    ModbusClient client(device);
    std::array<std::uint16_t, 5> words{};
    if (const auto fault = Read(client, words)) {
      GTEST_SKIP() << "skipped: localhost is not 127.0.0.1 here: " << fault->text;
    }
    EXPECT_EQ(words[0], 1007);
  } catch (const DeviceError& error) {
    GTEST_SKIP() << "skipped: this computer has no localhost: " << error.what();
  }
}

}  // namespace modbus_client_test
}  // namespace abbe::hal
