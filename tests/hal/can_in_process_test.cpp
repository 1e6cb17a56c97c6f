#include "hal/can/can_in_process.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace abbe::hal {
namespace can_in_process_test {

CanFrame Frame(std::uint32_t id, std::uint8_t first) {
  CanFrame frame{.id = id, .size = 2};
  frame.data[0] = first;
  return frame;
}

std::vector<ReceivedFrame> Drain(CanBus& bus, double until_s = 0.0) {
  std::vector<ReceivedFrame> all;
  while (const auto received = bus.Receive(until_s)) all.push_back(*received);
  return all;
}

class TwoOnAWire : public testing::Test {
 protected:
  HandClock clock_;
  CanInProcess wire_{clock_, 8};
  std::unique_ptr<CanBus> a_ = wire_.Join(), b_ = wire_.Join();
};

TEST_F(TwoOnAWire, EveryoneHearsAFrameWithItsTimeTheSenderAsItsOwn) {
  clock_.Advance(2.0);
  ASSERT_TRUE(a_->Send(Frame(0x181, 7)));
  clock_.Advance(1.0);
  const auto heard = Drain(*b_), echoed = Drain(*a_);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_EQ(heard[0].frame, Frame(0x181, 7));
  EXPECT_EQ(heard[0].time_s, 2.0);
  EXPECT_FALSE(heard[0].own);
  ASSERT_EQ(echoed.size(), 1u);
  EXPECT_TRUE(echoed[0].own);
}

TEST_F(TwoOnAWire, WaitsUntilItsDeadlineAndNotBeyond) {
  EXPECT_FALSE(b_->Receive(0.5).has_value());
  EXPECT_EQ(clock_.Now(), 0.5);
  wire_.Inject({.kind = CanTrouble::Kind::kLate, .late_s = 0.25});
  a_->Send(Frame(1, 1));
  EXPECT_FALSE(b_->Receive(0.7).has_value());
  const auto late = b_->Receive(1.0);
  ASSERT_TRUE(late.has_value());
  EXPECT_EQ(late->time_s, 0.75);
  EXPECT_EQ(clock_.Now(), 0.75);
}

TEST_F(TwoOnAWire, DoesToTheChosenFramesWhatItIsTold) {
  wire_.Inject({.kind = CanTrouble::Kind::kLost, .id = 0x182});
  wire_.Inject({.kind = CanTrouble::Kind::kDoubled, .id = 0x183, .every = 2});
  wire_.Inject({.kind = CanTrouble::Kind::kCorrupt, .id = 0x184, .mask = 0x0103});
  wire_.Inject({.kind = CanTrouble::Kind::kShort, .id = 0x185, .size = 1});
  for (const std::uint32_t id : {0x182u, 0x183u, 0x183u, 0x184u, 0x185u}) a_->Send(Frame(id, 1));
  const auto heard = Drain(*b_);
  ASSERT_EQ(heard.size(), 5u);  // 183, 183 twice, 184, 185
  EXPECT_EQ(heard[2].frame.id, 0x183u);
  EXPECT_EQ(heard[3].frame.data[0], 1 ^ 3);
  EXPECT_EQ(heard[3].frame.data[1], 1);
  EXPECT_EQ(heard[4].frame.size, 1);
  wire_.Heal();
  a_->Send(Frame(0x182, 1));
  EXPECT_EQ(Drain(*b_).size(), 1u);
}

TEST_F(TwoOnAWire, AFullQueueLosesTheNewestAndCountsThem) {
  for (std::uint8_t i = 0; i < 11; ++i) a_->Send(Frame(1, i));
  const auto heard = Drain(*b_);
  ASSERT_EQ(heard.size(), 8u);
  EXPECT_EQ(heard.back().frame.data[0], 7);
  EXPECT_EQ(b_->lost(), 3u);
}

TEST_F(TwoOnAWire, ABusThatIsOffTakesNothingAndSaysSo) {
  for (const CanState state : {CanState::kBusOff, CanState::kDown, CanState::kGone}) {
    wire_.SetState(state);
    EXPECT_FALSE(a_->Send(Frame(1, 1)));
    EXPECT_EQ(a_->Fault(), "CAN in process: " + std::string(NameOf(state)));
  }
  wire_.SetState(CanState::kPassive);
  EXPECT_TRUE(a_->Send(Frame(1, 1)));
  EXPECT_EQ(a_->Fault(), "");
}

TEST(CanInProcess, AListenerAnswersFromWithinTheCall) {
  HandClock clock;
  CanInProcess wire(clock);
  const auto master = wire.Join();
  std::unique_ptr<CanBus> node;
  node = wire.Join([&](const ReceivedFrame& heard) {
    if (heard.frame.id == 0x80) node->Send(Frame(0x181, 42));
  });
  master->Send({.id = 0x80});
  const auto heard = Drain(*master);
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[1].frame.data[0], 42);
}

TEST(CanInProcess, ParticipantsMayLiveInTheirOwnThreads) {
  SteadyClock clock;
  CanInProcess wire(clock);
  const auto a = wire.Join(), b = wire.Join();
  constexpr int kFrames = 2000;
  std::thread sender([&] {
    for (int i = 0; i < kFrames; ++i) a->Send(Frame(1, static_cast<std::uint8_t>(i)));
  });
  int next = 0;
  double before_s = 0.0;
  while (next < kFrames) {
    const auto received = b->Receive(clock.Now() + 10.0);
    ASSERT_TRUE(received.has_value()) << next;
    EXPECT_EQ(received->frame.data[0], static_cast<std::uint8_t>(next));
    EXPECT_GE(received->time_s, before_s);
    before_s = received->time_s;
    ++next;
  }
  sender.join();
}

}  // namespace can_in_process_test
}  // namespace abbe::hal
