// What transport.h says of a new transport, done: a dead-weight tester, whose force follows from
// the weights that the machine file lists, is one file and one line.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hal/combined_source.h"
#include "hal/recorder.h"
#include "recording/recording_file.h"

namespace abbe::hal {
namespace new_transport_test {

// The file: one device, its source, and the function that reads its table.

class WeightSource : public DeviceSource {
 public:
  WeightSource(const std::string& device, std::vector<double> weights, Clock& clock)
      : channels_{{"force_n", device}}, weights_(std::move(weights)), clock_(clock) {}
  void Require() override {}
  std::string Description() const override { return "weights"; }
  const std::vector<Channel>& channels() const override { return channels_; }
  SampleSet Read() override {
    SampleSet set;
    const double now = clock_.Now(), force = weights_[set_ % weights_.size()];
    set.sequence = ++set_;
    set.samples = {Sample::Good(force, now, set_)};
    FinishSet(set, now);
    return set;
  }

 private:
  std::vector<Channel> channels_;
  std::vector<double> weights_;
  Clock& clock_;
  std::uint64_t set_ = 0;
};

class Weights : public Device {
 public:
  explicit Weights(const settings::Table& table)
      : name_(table.key()), weights_(table.Quantities("weights_n", 3)) {}
  const std::string& name() const override { return name_; }
  std::vector<std::string> channels() const override { return {"force_n"}; }
  std::string_view channels_key() const override { return "weights_n"; }
  std::unique_ptr<DeviceSource> Open(Clock& clock, double, const Log&) const override {
    return std::make_unique<WeightSource>(name_, weights_, clock);
  }

 private:
  std::string name_;
  std::vector<double> weights_;
};

std::shared_ptr<const Device> ReadWeights(const settings::Table& table) {
  return std::make_shared<Weights>(table);
}

// The line.
std::vector<Transport> WithWeights() {
  std::vector<Transport> transports = Transports();
  transports.push_back({"weights", ReadWeights});
  return transports;
}

DevicesSettings Read(const std::string& text) {
  const auto document = settings::Document::Parse(text, "m.toml");
  return ReadDevices(document.Root().Child("devices"), WithWeights());
}

constexpr char kTester[] = "[devices.tester]\ntransport = 'weights'\nweights_n = [1.0, 2.0, 5.0]\n";

TEST(NewTransport, RecordsWithItsNameInTheHeader) {
  const DevicesSettings devices = Read(kTester);
  HandClock clock;
  const OpenedDevices opened = OpenDevices(devices, clock, Presence::kRequired);
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("new_transport_" + std::to_string(getpid()) + ".csv");
  std::filesystem::remove(path);
  const auto& channels = opened.source->channels();
  const auto writer = recording::Writer::Create(
      path, RecordHeader({"m", "2026-11-21T09:00:00Z", opened.transport}, channels),
      RecordColumns(channels));
  std::uint64_t rows = 0;
  RecordOptions options{.rate = 10.0};
  options.stopped = [&rows] { return rows++ == 6; };
  Record(*opened.source, clock, *writer, options);
  const recording::Recording recorded = recording::Read(path);
  std::filesystem::remove(path);
  const auto force = recorded.At("force_n");
  EXPECT_EQ(std::vector<double>(force.begin(), force.end()),
            (std::vector<double>{1.0, 2.0, 5.0, 1.0, 2.0, 5.0}));
  EXPECT_EQ(recorded.HeaderText("sources.tester").value_or(""), "weights: force_n");
}

TEST(NewTransport, IsReadAndRefusedLikeAnyOther) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      Read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(std::string(kTester) + "weigths_n = 1\n"),
            "m.toml:4: devices.tester.weigths_n: is not a known key; did you mean \"weights_n\"?");
  std::string second = kTester;
  second.replace(second.find("tester"), 6, "second");
  EXPECT_EQ(refusal(kTester + second),
            "m.toml:6: devices.second.weights_n: the channel name \"force_n\" is used twice");
  EXPECT_EQ(refusal("[devices.tester]\ntransport = 'weight'\n"),
            "m.toml:2: devices.tester.transport: \"weight\" is not one of: modbus-tcp, "
            "modbus-rtu, canopen, weights");
}

}  // namespace new_transport_test
}  // namespace abbe::hal
