// CANopen encoders that run on python-can, or on the npm packages canopen and socketcan, over
// SocketCAN in a guest: what the client makes of them
// when all is well, and when the bus or a node is not.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "../folders.h"
#include "can_guest.h"
#include "hal/can/canopen_device.h"
#include "hal/can/canopen_source.h"
#include "hal/combined_source.h"
#include "hal/modbus/modbus_device.h"
#include "hal/modbus/modbus_server.h"

namespace abbe::hal {
namespace canopen_guest_test {

constexpr int kPerTurn = 1 << 16;

CanopenSettings Linkage() {
  CanopenSettings settings{.name = "linkage", .interface = "vcan0", .times = {}, .encoders = {}};
  for (int i = 1; i <= 3; ++i) {
    EncoderSettings encoder;
    encoder.name = "pivot_" + std::to_string(i) + "_rad";
    encoder.node = i;
    encoder.counts_per_turn = kPerTurn;
    encoder.range = kPerTurn;
    settings.encoders.push_back(encoder);
  }
  // The guest has one virtual processor, which the whole computer shares.
  settings.times.answer = 0.3;
  settings.times.heartbeat = 5.0;
  return settings;
}

// Programs that are encoders: can_encoders.py or npm_encoders/encoders.js.
std::vector<std::string> OnPython() {
  return {"/usr/bin/python3", SourceFolder() / "tests/hal/can_encoders.py"};
}
std::vector<std::string> OnNpm() {
  return {"env", "NODE_PATH=" ABBE_NPM_ENCODERS, ABBE_NODE,
          SourceFolder() / "tests/hal/npm_encoders/encoders.js"};
}

class Encoders {
 public:
  Encoders(std::vector<std::string> command, const std::vector<std::string>& nodes)
      : command_(std::move(command)) {
    command_.insert(command_.end(), {"vcan0", std::to_string(kPerTurn)});
    command_.insert(command_.end(), nodes.begin(), nodes.end());
    Start();
  }
  void Start() {
    process_ = std::make_unique<ChildProcess>(command_);
    EXPECT_EQ(process_->Line(), "ready");
  }
  ChildProcess& process() { return *process_; }

 private:
  std::vector<std::string> command_;
  std::unique_ptr<ChildProcess> process_;
};

class CanopenGuest : public CanGuest {
 protected:
  void SetUp() override {
    CanGuest::SetUp();
    if (IsSkipped()) return;
    two_ = std::make_unique<Encoders>(Program(), std::vector<std::string>{"1", "2"});
    third_ = std::make_unique<Encoders>(Program(), std::vector<std::string>{"3"});
    settings_ = Linkage();
  }
  virtual std::vector<std::string> Program() { return OnPython(); }
  void Open() {
    source_ = std::make_unique<CanopenSource>(settings_, 1.0,
                                              std::make_unique<CanSocket>("vcan0", clock_), clock_);
    source_->Require();
  }
  // The number of SYNCs that an encoder had seen when it gave this sample.
  static long SyncsOf(const Sample& sample, int node) {
    const long counts = std::lround(sample.value / (2.0 * M_PI) * kPerTurn);
    EXPECT_EQ((counts - 1000 * node) % 7, 0);
    return (counts - 1000 * node) / 7;
  }
  // Reads `count` sets. What is good in them belongs to the SYNC of its set. Returns the number of
  // complete sets.
  int ReadAndCheck(int count) {
    int complete = 0;
    for (int i = 0; i < count && !HasFailure(); ++i) {
      const SampleSet set = source_->Read();
      if (set.AllGood()) ++complete;
      for (std::size_t n = 0; n < 3; ++n) {
        const Sample& sample = set.samples[n];
        EXPECT_EQ(std::isnan(sample.value), !sample.good());
        if (!sample.good()) continue;
        EXPECT_EQ(started_ + SyncsOf(sample, static_cast<int>(n) + 1),
                  static_cast<long>(source_->counts().syncs))
            << "set " << i << ", node " << n + 1;
      }
    }
    return complete;
  }
  bool BecomesGood() {
    const double until = clock_.Now() + 30.0;
    while (clock_.Now() < until) {
      if (source_->Read().AllGood()) return true;
    }
    return false;
  }
  bool BecomesBad(std::size_t channel, Cause cause) {
    const double until = clock_.Now() + 30.0;
    while (clock_.Now() < until) {
      if (source_->Read().samples[channel].cause == cause) return true;
    }
    return false;
  }

  CanopenSettings settings_;
  std::unique_ptr<Encoders> two_, third_;
  std::unique_ptr<CanopenSource> source_;
  long started_ = 0;  // SYNCs before the encoders counted
};

// The two kinds of encoders differ: those on npm say no boot-up and answer questions without a
// size.
class CanopenPeers : public CanopenGuest, public testing::WithParamInterface<bool> {
 protected:
  std::vector<std::string> Program() override { return GetParam() ? OnNpm() : OnPython(); }
};
INSTANTIATE_TEST_SUITE_P(, CanopenPeers, testing::Bool(),
                         [](const auto& peer) { return peer.param ? "Npm" : "Python"; });

TEST_P(CanopenPeers, EveryGoodValueBelongsToItsSync) {
  Open();
  const SampleSet first = source_->Read();
  ASSERT_TRUE(first.AllGood());
  EXPECT_EQ(first.skew_s, 0.0);
  started_ = static_cast<long>(source_->counts().syncs) - SyncsOf(first.samples[0], 1);
  EXPECT_GT(ReadAndCheck(200), 0);

  Run("tc qdisc add dev vcan0 root netem loss 10%");
  const int complete = ReadAndCheck(40);
  EXPECT_GT(complete, 0);
  EXPECT_LT(complete, 40);
  // SYNC and answer together later than allowed, but not by more than that again.
  Run("tc qdisc replace dev vcan0 root netem delay 180ms 90ms");
  ReadAndCheck(6);
  Run("tc qdisc replace dev vcan0 root netem duplicate 30%");
  ReadAndCheck(40);
  EXPECT_GT(source_->counts().unasked, 0u);
  Run("tc qdisc del dev vcan0 root");
  EXPECT_TRUE(BecomesGood());
}

TEST_F(CanopenGuest, CorruptFramesSpoilNothingForGood) {
  Open();
  Run("tc qdisc add dev vcan0 root netem corrupt 20%");
  int bad = 0;
  for (int i = 0; i < 30; ++i) bad += source_->Read().AllGood() ? 0 : 1;
  EXPECT_GT(bad, 0);
  Run("tc qdisc del dev vcan0 root");
  source_->Read();
  // A real bus checks every frame; here a flipped bit may look like a restart or an emergency.
  source_->ConfirmReference();
  for (const char* node : {"1", "2", "3"}) {
    Run(std::string("cansend vcan0 08") + node + "#0000000000000000");
  }
  EXPECT_TRUE(BecomesGood()) << source_->Fault();
}

TEST_F(CanopenGuest, ASilencedNodeIsNamedAndTheOthersGoOn) {
  Open();
  for (const char* module : {"net/sched/sch_prio", "net/sched/em_canid", "net/sched/cls_basic"}) {
    Run(std::string("insmod /usr/lib/uml/modules/$(uname -r)/kernel/") + module + ".ko");
  }
  Run("tc qdisc add dev vcan0 root handle 1: prio && "
      "tc qdisc add dev vcan0 parent 1:3 netem loss 100% && "
      "tc filter add dev vcan0 parent 1: protocol all basic match 'canid(sff 0x182)' flowid 1:3 "
      "&& tc filter add dev vcan0 parent 1: protocol all prio 9 basic match 'not canid(sff 0x182)' "
      "flowid 1:1");
  EXPECT_TRUE(BecomesBad(1, Cause::kNoReply));
  const SampleSet set = source_->Read();
  EXPECT_TRUE(set.samples[0].good());
  EXPECT_FALSE(set.samples[1].good());
  EXPECT_TRUE(set.samples[2].good());
  EXPECT_NE(source_->Fault().find("node 2 (pivot_2_rad) sent no PDO 1"), std::string::npos);
  Run("tc qdisc del dev vcan0 root");
  EXPECT_TRUE(BecomesGood()) << source_->Fault();
}

TEST_P(CanopenPeers, AFrozenNodeIsLostAndComesBack) {
  Open();
  third_->process().Signal(SIGSTOP);
  EXPECT_TRUE(BecomesBad(2, Cause::kNoReply));
  const double until = clock_.Now() + 30.0;
  while (source_->Fault().find("node 3 (pivot_3_rad): no heartbeat") == std::string::npos &&
         clock_.Now() < until) {
    source_->Read();
  }
  EXPECT_LT(clock_.Now(), until) << source_->Fault();
  EXPECT_TRUE(source_->Read().samples[0].good());
  third_->process().Signal(SIGCONT);
  EXPECT_TRUE(BecomesGood()) << source_->Fault();
}

TEST_P(CanopenPeers, ARestartedNodeHasLostItsReference) {
  Open();
  third_->process().Kill();
  EXPECT_TRUE(BecomesBad(2, Cause::kNoReply));
  third_->Start();
  EXPECT_TRUE(BecomesBad(2, Cause::kReferenceLost));
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(source_->Read().samples[2].good());
  source_->ConfirmReference();
  EXPECT_TRUE(BecomesGood()) << source_->Fault();
}

TEST_F(CanopenGuest, TheInterfaceMayGoDownAndComeBack) {
  Open();
  Run("ip link set vcan0 down");
  EXPECT_TRUE(BecomesBad(0, Cause::kNoReply));
  EXPECT_EQ(source_->Fault(),
            "device \"linkage\": vcan0: is down: switch it on with `ip link set vcan0 up`");
  Run("ip link set vcan0 up");
  EXPECT_TRUE(BecomesGood()) << source_->Fault();
}

TEST_F(CanopenGuest, AnEmergencySpoilsItsNodeUntilItIsOver) {
  Open();
  Run("cansend vcan0 082#1031050000000000");
  EXPECT_TRUE(BecomesBad(1, Cause::kSensorFault));
  EXPECT_NE(source_->Fault().find("emergency 3110h (voltage), error register 05h"),
            std::string::npos);
  Run("cansend vcan0 082#0000000000000000");
  EXPECT_TRUE(BecomesGood());
}

TEST_F(CanopenGuest, WrongCountsPerTurnAreRefused) {
  settings_.encoders[1].counts_per_turn = 4096;
  try {
    Open();
    FAIL() << "accepted";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("node 2 (pivot_2_rad): counts 65536 a turn, the machine file says 4096"),
              std::string::npos)
        << error.what();
  }
}

// Probes over Modbus and encoders over CAN: one set, one clock, and the time between them measured.
TEST_F(CanopenGuest, ReadsProbesAndEncodersAsOneSet) {
  RegisterImage image;
  image.Set(1, RegisterTable::kInput, 0, {100});
  const auto server = ModbusServer::ListenTcp("127.0.0.1", 0, image);
  DevicesSettings devices;
  devices.max_skew = 1.0;
  ModbusSettings head;
  head.name = "head";
  head.host = "127.0.0.1";
  head.port = server->port();
  ChannelSettings probe;
  probe.name = "probe_a_um";
  probe.may_freeze = true;
  head.blocks.push_back({RegisterTable::kInput, 0, 1, {probe}});
  devices.devices = {std::make_shared<ModbusDevice>(head),
                     std::make_shared<CanopenDevice>(settings_)};
  const OpenedDevices opened = OpenDevices(devices, clock_, Presence::kRequired);
  ASSERT_EQ(opened.source->channels().size(), 4u);
  EXPECT_EQ(opened.source->channels()[3].name, "pivot_3_rad");
  std::vector<double> skews;
  double before_s = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double start = clock_.Now();
    const SampleSet set = opened.source->Read();
    const double end = clock_.Now();
    ASSERT_TRUE(set.AllGood()) << opened.source->Fault();
    for (const Sample& sample : set.samples) {
      EXPECT_GE(sample.time_s, start);
      EXPECT_LE(sample.time_s, end);
    }
    EXPECT_GT(set.samples[1].time_s, set.samples[0].time_s);
    EXPECT_EQ(set.samples[1].time_s, set.samples[3].time_s);
    // From the begin of the exchange with the probe to the SYNC of the encoders.
    EXPECT_GE(set.skew_s, set.samples[1].time_s - set.samples[0].time_s);
    EXPECT_LE(set.skew_s, end - start);
    EXPECT_GT(set.time_s, before_s);
    before_s = set.time_s;
    skews.push_back(set.skew_s);
  }
  std::sort(skews.begin(), skews.end());
  std::printf("skew of Modbus and CAN: median %.2f ms, worst %.2f ms\n", 1e3 * skews[100],
              1e3 * skews.back());
}

}  // namespace canopen_guest_test
}  // namespace abbe::hal
