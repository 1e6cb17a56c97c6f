#include "hal/can/canopen_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "can_encoder_node.h"

namespace abbe::hal {
namespace canopen_source_test {

constexpr double kStale = 1.0;

CanopenSettings Linkage() {
  CanopenSettings settings{.name = "linkage", .interface = "memory", .times = {}, .encoders = {}};
  for (int i = 1; i <= 3; ++i) {
    EncoderSettings encoder;
    encoder.name = "pivot_" + std::to_string(i) + "_rad";
    encoder.node = i;
    encoder.counts_per_turn = 1 << 20;
    encoder.range = 1 << 20;
    settings.encoders.push_back(encoder);
  }
  return settings;
}

// While somebody waits on the bus, the world goes on: the nodes beat ten times a second.
class BeatingClock : public HandClock {
 public:
  void WaitUntil(double time_s, std::unique_lock<std::mutex>& lock,
                 std::condition_variable&) override {
    SleepUntil(std::min(time_s, Now() + 0.1));
    if (!beat) return;
    lock.unlock();
    beat();
    lock.lock();
  }
  std::function<void()> beat;
};

class ThreeEncoders : public testing::Test {
 protected:
  ThreeEncoders() {
    for (const EncoderSettings& encoder : settings_.encoders) {
      nodes_.push_back(std::make_unique<CanEncoderNode>(
          wire_, encoder, [this, &encoder] { return CountOf(encoder, angle_); }));
    }
  }
  CanopenSource& Open(CanopenSource::Part part = CanopenSource::Part::kMaster) {
    source_ = std::make_unique<CanopenSource>(
        settings_, kStale, wire_.Join(), clock_,
        [this](const std::string& line) { log_.push_back(line); }, part);
    Beat();
    return *source_;
  }
  void Beat() {
    for (auto& node : nodes_) node->Beat();
  }
  SampleSet Next() {
    clock_.Advance(0.01);
    Beat();
    return source_->Read();
  }
  std::string RequireError() {
    clock_.beat = [this] { Beat(); };
    std::string error_text = "accepted";
    try {
      Open().Require();
    } catch (const DeviceError& error) {
      error_text = error.what();
    }
    clock_.beat = {};
    return error_text;
  }

  CanopenSettings settings_ = Linkage();
  BeatingClock clock_;
  CanInProcess wire_{clock_};
  double angle_ = 0.5;
  std::vector<std::unique_ptr<CanEncoderNode>> nodes_;
  std::unique_ptr<CanopenSource> source_;
  std::vector<std::string> log_;
};

TEST_F(ThreeEncoders, AreAskedStartedAndReadAtOneMoment) {
  Open().Require();
  for (const auto& node : nodes_) EXPECT_EQ(node->state, NmtState::kOperational);
  angle_ = 0.6;
  const double before = clock_.Now();
  const SampleSet set = Next();
  ASSERT_TRUE(set.AllGood());
  EXPECT_EQ(set.skew_s, 0.0);
  EXPECT_NEAR(set.samples[0].time_s, before + 0.01, 1e-12);
  for (const Sample& sample : set.samples) {
    EXPECT_NEAR(sample.value, 0.6, 0.5 * settings_.encoders[0].Step());
  }
  EXPECT_EQ(source_->counts().missing, 0u);
}

TEST_F(ThreeEncoders, AMissingNodeIsNamed) {
  nodes_[1]->beats = false;
  EXPECT_EQ(RequireError(),
            "device \"linkage\" (memory): node 2 (pivot_2_rad): no heartbeat for 500 ms; check "
            "that the bus is up, its ends, and the nodes with their ids in the machine file");
  nodes_[1]->beats = true;
  nodes_[1]->answers_sdo = false;
  EXPECT_NE(RequireError().find("node 2 (pivot_2_rad): does not answer questions (SDO)"),
            std::string::npos)
      << RequireError();
}

TEST_F(ThreeEncoders, AnEncoderThatIsNotAsDescribedIsNeverGood) {
  nodes_[0]->objects[{0x6001, 0}] = 4096;
  EXPECT_NE(RequireError().find(
                "node 1 (pivot_1_rad): counts 4096 a turn, the machine file says 1048576"),
            std::string::npos)
      << RequireError();
  EXPECT_EQ(Next().samples[0].cause, Cause::kMismatch);
  nodes_[0]->objects[{0x6001, 0}] = 1 << 20;
  nodes_[0]->objects[{0x6002, 0}] = 1u << 25;
  EXPECT_NE(RequireError().find("begins again after 33554432 counts"), std::string::npos);
}

// Two encoders that were swapped look alike but for their serial numbers.
TEST_F(ThreeEncoders, SwappedEncodersAreNoticedByTheirSerialNumbers) {
  settings_.encoders[0].serial = 1002;
  EXPECT_NE(RequireError().find(
                "node 1 (pivot_1_rad): has the serial number 1001, the machine file says 1002"),
            std::string::npos);
}

// Without scaling (bit 2 of 6000h) the physical resolution holds, whatever 6001h and 6002h say.
TEST_F(ThreeEncoders, UnscaledEncodersAreComparedByTheirPhysicalResolution) {
  auto& objects = nodes_[0]->objects;
  objects[{0x6000, 0}] = 0;
  objects[{0x6001, 0}] = objects[{0x6002, 0}] = 4096;
  objects[{0x6501, 0}] = 1 << 20;
  objects[{0x6502, 0}] = 1;
  EXPECT_EQ(RequireError(), "accepted");
  objects[{0x6502, 0}] = 16;
  EXPECT_NE(RequireError().find("begins again after 16777216"), std::string::npos);
}

TEST_F(ThreeEncoders, ANodeThatTellsNothingIsTaken) {
  for (auto& node : nodes_) node->objects.clear();
  EXPECT_EQ(RequireError(), "accepted");
}

class Restarted : public ThreeEncoders, public testing::WithParamInterface<bool> {};

TEST_P(Restarted, HasLostItsReferenceUntilItIsConfirmed) {
  Open().Require();
  Next();
  nodes_[2]->Reboot(GetParam());
  bool flowed_again = false;
  for (int i = 0; i < 50; ++i) {
    const SampleSet set = Next();
    EXPECT_TRUE(set.samples[0].good());
    EXPECT_EQ(set.samples[2].cause, Cause::kReferenceLost);
    flowed_again = flowed_again || nodes_[2]->state == NmtState::kOperational;
  }
  EXPECT_TRUE(flowed_again);
  EXPECT_NE(source_->Fault().find("node 3 (pivot_3_rad) has restarted"), std::string::npos);
  EXPECT_EQ(source_->counts().restarts, 1u);
  source_->ConfirmReference();
  EXPECT_TRUE(Next().AllGood());
  EXPECT_EQ(source_->Fault(), "");
  ASSERT_EQ(log_.size(), 4u);  // waiting for them to start, well, lost, well
  EXPECT_EQ(log_.back(), "device \"linkage\" (memory): has recovered");
}

INSTANTIATE_TEST_SUITE_P(WithOrWithoutABootUpFrame, Restarted, testing::Bool());

// Before its first heartbeat as an operational node, and without a boot-up frame.
TEST_F(ThreeEncoders, ANodeThatRestartsAtOnceHasLostItsReferenceToo) {
  Open().Require();
  nodes_[2]->Reboot(false);
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(Next().samples[2].good());
  EXPECT_EQ(Next().samples[2].cause, Cause::kReferenceLost);
}

TEST_F(ThreeEncoders, ADoubledAnswerIsOneReading) {
  Open().Require();
  wire_.Inject({.kind = CanTrouble::Kind::kDoubled, .id = 0x182});
  for (int i = 0; i < 10; ++i) {
    angle_ += 0.01;
    const SampleSet set = Next();
    ASSERT_TRUE(set.AllGood());
    EXPECT_NEAR(set.samples[1].value, angle_, 1e-5);
  }
  EXPECT_GE(source_->counts().unasked, 9u);
}

// Every answer later than allowed, but sooner than the next SYNC would be without the pause: none
// may be taken for the answer to the SYNC after it.
TEST_F(ThreeEncoders, ALateAnswerIsNeverTakenForTheNext) {
  Open().Require();
  wire_.Inject({.kind = CanTrouble::Kind::kLate, .id = 0x182, .late_s = 0.035});
  for (int i = 0; i < 20; ++i) {
    angle_ += 0.05;
    const SampleSet set = source_->Read();
    Beat();
    EXPECT_EQ(set.samples[1].cause, Cause::kNoReply);
    EXPECT_TRUE(set.samples[0].good());
  }
}

TEST_F(ThreeEncoders, ACorruptCountIsAJump) {
  Open().Require();
  wire_.Inject({.kind = CanTrouble::Kind::kCorrupt, .id = 0x181, .mask = 0x40000, .every = 2});
  int jumps = 0;
  for (int i = 0; i < 10; ++i) {
    const SampleSet set = Next();
    if (set.samples[0].good()) {
      EXPECT_NEAR(set.samples[0].value, angle_, 1e-5);
    } else {
      EXPECT_EQ(set.samples[0].cause, Cause::kJump);
      ++jumps;
    }
  }
  EXPECT_EQ(jumps, 5);
}

TEST_F(ThreeEncoders, SyncsKeepTheirDistance) {
  settings_.times.sync = 0.25;
  Open().Require();
  double before = source_->Read().time_s;
  for (int i = 0; i < 5; ++i) {
    Beat();
    const double now = source_->Read().time_s;
    EXPECT_NEAR(now - before, 0.25, 1e-9);
    before = now;
  }
}

TEST_F(ThreeEncoders, ASecondMasterIsNoticed) {
  Open().Require();
  const auto other = wire_.Join([](const ReceivedFrame&) {});
  clock_.Advance(0.01);
  other->Send(SyncFrame());
  EXPECT_FALSE(source_->Read().AllGood());
  EXPECT_NE(source_->Fault().find("a SYNC came that abbe did not send"), std::string::npos);
  clock_.Advance(0.01);
  EXPECT_TRUE(Next().AllGood());
}

// Every second SYNC and every answer arrives doubled, and the node needs a while: what it answers to
// the double of a SYNC comes after both copies of its first answer.
TEST_F(ThreeEncoders, AnAnswerToADoubledSyncIsNeverTakenForTheNext) {
  nodes_.resize(1);
  settings_.encoders.resize(1);
  Open().Require();
  wire_.Inject({.kind = CanTrouble::Kind::kDoubled, .id = kSyncId, .every = 2});
  wire_.Inject({.kind = CanTrouble::Kind::kLate, .id = 0x181, .late_s = 0.005});
  wire_.Inject({.kind = CanTrouble::Kind::kLate, .id = 0x181, .late_s = 0.003, .every = 3});
  wire_.Inject({.kind = CanTrouble::Kind::kDoubled, .id = 0x181});
  int good = 0;
  for (int i = 0; i < 20; ++i) {
    angle_ += 0.01;
    const SampleSet set = source_->Read();
    Beat();
    if (!set.AllGood()) continue;
    ++good;
    EXPECT_NEAR(set.samples[0].value, angle_, 1e-5) << "set " << i;
  }
  EXPECT_EQ(good, 10);
}

// A bus that another commands: every SYNC of it is one reading, at its own time.
TEST_F(ThreeEncoders, AListenerTakesTheSyncsOfAnother) {
  Open(CanopenSource::Part::kListener);
  const auto other = wire_.Join([](const ReceivedFrame&) {});
  other->Send(NmtFrame(NmtCommand::kStart, 0));
  for (int i = 0; i < 5; ++i) {
    clock_.Advance(0.01);
    angle_ += 0.01;
    other->Send(SyncFrame());
  }
  nodes_[1]->state = NmtState::kStopped;
  clock_.Advance(0.01);
  other->Send(SyncFrame());
  nodes_[1]->state = NmtState::kOperational;
  clock_.Advance(0.01);
  other->Send(SyncFrame());
  for (int i = 1; i <= 7; ++i) {
    const SampleSet set = source_->Read();
    EXPECT_NEAR(set.samples[0].time_s, 0.01 * i, 1e-12);
    EXPECT_EQ(set.samples[1].good(), i != 6) << i;
    EXPECT_NEAR(set.samples[0].value, 0.5 + 0.01 * std::min(i, 5), 1e-5);
  }
}

// Nodes that send by themselves, without any SYNC: each PDO has its own time.
TEST_F(ThreeEncoders, AListenerTakesCyclicPdos) {
  settings_.times.sync = 0.0;
  Open(CanopenSource::Part::kListener);
  for (int i = 0; i < 3; ++i) {
    for (auto& node : nodes_) {
      clock_.Advance(0.001);
      node->SendPdo();
    }
  }
  for (int i = 0; i < 3; ++i) {
    const SampleSet set = source_->Read();
    EXPECT_TRUE(set.AllGood());
    EXPECT_NEAR(set.skew_s, 0.002, 1e-12);
    EXPECT_NEAR(set.time_s, 0.003 * i + 0.002, 1e-12);
  }
}

TEST_F(ThreeEncoders, AnErrorPassiveBusIsAWarningAndItsReadingsAreGood) {
  Open().Require();
  log_.clear();
  wire_.SetState(CanState::kPassive);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(Next().AllGood());
  EXPECT_EQ(source_->Fault(), "");
  ASSERT_EQ(log_.size(), 1u);
  EXPECT_NE(log_[0].find("passive"), std::string::npos) << log_[0];
  wire_.SetState(CanState::kActive);
  EXPECT_TRUE(Next().AllGood());
  ASSERT_EQ(log_.size(), 2u);
  EXPECT_NE(log_[1].find("no more errors"), std::string::npos) << log_[1];
}

TEST_F(ThreeEncoders, FramesThatFoundNoRoomSpoilTheirSet) {
  Open().Require();
  const auto babbler = wire_.Join();
  for (int i = 0; i < 5000; ++i) babbler->Send({.id = 0x300, .size = 1});  // 4096 may wait
  const SampleSet set = Next();
  EXPECT_GT(source_->bus().lost(), 0u);
  for (const Sample& sample : set.samples) {
    EXPECT_EQ(sample.cause, Cause::kNoReply);
    EXPECT_TRUE(std::isnan(sample.value));
  }
  EXPECT_NE(source_->Fault().find("found no room to wait"), std::string::npos) << source_->Fault();
  Next();
  EXPECT_TRUE(Next().AllGood());
  EXPECT_EQ(source_->Fault(), "");
}

}  // namespace canopen_source_test
}  // namespace abbe::hal
