// The contract of transport.h, held against every transport of the registry: each is opened from a
// table of a machine file, with a device that answers and with one that is not there.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "can_encoder_node.h"
#include "hal/can/canopen_device.h"
#include "hal/combined_source.h"
#include "hal/modbus/modbus_server.h"
#include "hal/recorder.h"
#include "recording/recording_file.h"

namespace abbe::hal {
namespace transport_contract_test {

// A device with one channel that shows `value`.
class Answering {
 public:
  virtual ~Answering() = default;
  virtual std::string Table() const = 0;  // its keys in the machine file, without `transport`
  virtual std::string Description() const = 0;
  virtual double value() const = 0;
  // The transport of the registry, or the same over a bus in memory.
  virtual Transport Through(const Transport& transport) { return transport; }

  HandClock clock;
};

struct TransportCase {
  std::string transport;
  std::string channel;
  std::string absent;  // the table of a device that is not there
  std::function<std::unique_ptr<Answering>()> answering;
};

constexpr char kRegister[] =
    "response_timeout_ms = 5000\ndeadline_ms = 10000\n"
    "block = [{address = 0, count = 1, channel = [{name = 'force_n', at = 0, type = 'uint16', "
    "scale = 0.5, may_freeze = true}]}]\n";

class ModbusBank : public RegisterImage {
 public:
  ModbusBank() { Set(1, RegisterTable::kInput, 0, {1000}); }
  std::vector<std::string> Identity(int) override { return {"Maker", "Gauge 1", "2.0"}; }
};

class AnsweringModbus : public Answering {
 public:
  explicit AnsweringModbus(ModbusFraming framing)
      : tcp_(framing == ModbusFraming::kTcp),
        server_(tcp_ ? ModbusServer::ListenTcp("127.0.0.1", 0, bank_)
                     : ModbusServer::OpenPty(1, bank_)) {}
  std::string Table() const override {
    return (tcp_ ? "host = '127.0.0.1'\nport = " + std::to_string(server_->port())
                 : "serial = {device = '" + server_->device() + "', parity = 'none'}") +
           "\n" + kRegister;
  }
  std::string Description() const override { return "modbus, Maker Gauge 1 2.0"; }
  double value() const override { return 500.0; }

 private:
  bool tcp_;
  ModbusBank bank_;
  std::unique_ptr<ModbusServer> server_;
};

constexpr char kNode[] =
    "heartbeat_timeout_ms = 0\n"
    "node = [{id = 1, name = 'pivot_1_rad', counts_per_turn = 1000, range = 4000}]\n";

class AnsweringEncoder : public Answering {
 public:
  std::string Table() const override { return std::string("interface = 'memory'\n") + kNode; }
  std::string Description() const override { return "canopen"; }
  double value() const override { return 0.5 * std::numbers::pi; }
  Transport Through(const Transport& transport) override {
    return {transport.name, [this, read = transport.read](const settings::Table& table) {
              const auto device = read(table);
              const auto& settings = dynamic_cast<const CanopenDevice&>(*device).settings();
              node_ = std::make_unique<CanEncoderNode>(wire_, settings.encoders.at(0),
                                                       [] { return 250; });
              return std::make_shared<CanopenDevice>(
                  settings, [this](const std::string&, Clock&) { return wire_.Join(); });
            }};
  }

 private:
  CanInProcess wire_{clock};
  std::unique_ptr<CanEncoderNode> node_;
};

std::vector<TransportCase> Cases() {
  return {
      {"modbus-tcp", "force_n", std::string("host = '127.0.0.1'\nport = 1\n") + kRegister,
       [] { return std::make_unique<AnsweringModbus>(ModbusFraming::kTcp); }},
      {"modbus-rtu", "force_n",
       std::string("serial = {device = '/dev/no_such_line'}\n") + kRegister,
       [] { return std::make_unique<AnsweringModbus>(ModbusFraming::kRtu); }},
      {"canopen", "pivot_1_rad", std::string("interface = 'nocan0'\n") + kNode,
       [] { return std::make_unique<AnsweringEncoder>(); }},
  };
}

DevicesSettings Read(const std::string& text, const std::vector<Transport>& transports) {
  return ReadDevices(settings::Document::Parse(text, "m.toml").Root().Child("devices"), transports);
}

std::string Refusal(const std::string& text) {
  try {
    Read(text, Transports());
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Transports, AreAllHeldToTheContract) {
  std::vector<std::string> listed, held;
  for (const Transport& transport : Transports()) listed.push_back(transport.name);
  for (const TransportCase& each : Cases()) held.push_back(each.transport);
  EXPECT_EQ(listed, held);
}

class TransportContract : public testing::TestWithParam<TransportCase> {
 protected:
  std::string Head() const { return "[devices.d]\ntransport = '" + GetParam().transport + "'\n"; }
};

TEST_P(TransportContract, ReadsItsTable) {
  const DevicesSettings all = Read(Head() + GetParam().absent, Transports());
  ASSERT_EQ(all.devices.size(), 1u);
  EXPECT_EQ(all.devices[0]->name(), "d");
  EXPECT_EQ(all.devices[0]->channels(), std::vector<std::string>{GetParam().channel});
}

TEST_P(TransportContract, RefusesAnUnknownKeyWithItsLine) {
  const std::string refusal = Refusal(Head() + "no_such_key = 1\n" + GetParam().absent);
  EXPECT_EQ(refusal.find("m.toml:3: devices.d.no_such_key: is not a known key"), 0u) << refusal;
}

TEST_P(TransportContract, RefusesATableWithoutItsKeys) {
  const std::string refusal = Refusal(Head());
  EXPECT_EQ(refusal.find("m.toml:"), 0u) << refusal;  // a table that is missing has no line
  EXPECT_NE(refusal.find(" devices.d."), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("is missing"), std::string::npos) << refusal;
}

TEST_P(TransportContract, RefusesAChannelThatAnotherDeviceHas) {
  const std::string twice = Head() + GetParam().absent + "[devices.e]\ntransport = '" +
                            GetParam().transport + "'\n" + GetParam().absent;
  const std::string refusal = Refusal(twice);
  EXPECT_NE(refusal.find("the channel name \"" + GetParam().channel + "\" is used twice"),
            std::string::npos)
      << refusal;
}

TEST_P(TransportContract, ADeviceThatIsNotThereIsNamedWithARemedy) {
  const DevicesSettings all = Read(Head() + GetParam().absent, Transports());
  SteadyClock clock;
  try {
    OpenDevices(all, clock, Presence::kRequired);
    FAIL() << "opened";
  } catch (const DeviceError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find("device \"d\" ("), 0u) << text;
    EXPECT_NE(text.find("; check"), std::string::npos) << text;
  }
}

TEST_P(TransportContract, ADeviceThatIsAwaitedGivesBadSamplesAndItsTimesGoForward) {
  const DevicesSettings all = Read(Head() + GetParam().absent, Transports());
  SteadyClock clock;
  const OpenedDevices opened = OpenDevices(all, clock, Presence::kAwaited);
  double before_s = 0.0;
  for (int i = 0; i < 5; ++i) {
    const SampleSet set = opened.source->Read();
    ASSERT_EQ(set.samples.size(), 1u);
    EXPECT_EQ(set.samples[0].quality, Quality::kBad);
    EXPECT_TRUE(std::isnan(set.samples[0].value));
    EXPECT_GE(set.time_s, before_s);
    before_s = set.time_s;
    EXPECT_EQ(opened.source->Fault().find("device \"d\": "), 0u) << opened.source->Fault();
  }
}

TEST_P(TransportContract, ADeviceThatAnswersIsRecordedWithItsDescription) {
  const auto device = GetParam().answering();
  std::vector<Transport> transports = Transports();
  const auto own = std::ranges::find(transports, GetParam().transport, &Transport::name);
  *own = device->Through(*own);
  const DevicesSettings all = Read(Head() + device->Table(), transports);
  const OpenedDevices opened = OpenDevices(all, device->clock, Presence::kRequired);
  EXPECT_EQ(opened.transport.at("d"), device->Description());
  EXPECT_FALSE(opened.start_cycle);
  device->clock.Advance(0.1);  // a reading as old as that of Require() would be stale

  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("transport_" + GetParam().transport + std::to_string(getpid()) + ".csv");
  std::filesystem::remove(path);
  const auto& channels = opened.source->channels();
  const auto writer = recording::Writer::Create(
      path, RecordHeader({"m", "2026-11-21T09:00:00Z", opened.transport}, channels),
      RecordColumns(channels));
  const RecordOutcome outcome =
      Record(*opened.source, device->clock, *writer, {.rate = 10.0, .seconds = 2.0});
  EXPECT_EQ(outcome.flagged, 0u) << outcome.worst_channel << outcome.fault;
  EXPECT_NEAR(static_cast<double>(outcome.rows), 20.0, 1.0);

  const recording::Recording read = recording::Read(path);
  std::filesystem::remove(path);
  EXPECT_EQ(read.HeaderText("sources.d").value_or(""),
            device->Description() + ": " + GetParam().channel);
  const auto times = read.At("time_s");
  for (std::size_t row = 1; row < times.size(); ++row) EXPECT_GT(times[row], times[row - 1]);
  for (const double value : read.At(GetParam().channel)) {
    EXPECT_NEAR(value, device->value(), 1e-9);
  }
}

std::string CaseOf(const testing::TestParamInfo<TransportCase>& each) {
  std::string name = each.param.transport;
  std::ranges::replace(name, '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, TransportContract, testing::ValuesIn(Cases()), CaseOf);

}  // namespace transport_contract_test
}  // namespace abbe::hal
