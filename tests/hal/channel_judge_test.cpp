#include "hal/modbus/channel_judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace abbe::hal {
namespace channel_judge_test {

using Words = std::vector<std::uint16_t>;

// WAGO 750-456 by its manual: 8000h...7FF8h for -10...10 V, the low three bits are status, 8001h
// under range, 7FF9h over range.
ChannelSettings Wago() {
  ChannelSettings channel;
  channel.name = "probe_a_um";
  channel.type = WordType::kInt16;
  channel.scale = 20.0 * 10.0 / 32768.0;  // 20 um a volt
  channel.status = StatusRule{0, RegisterTable::kInput, 0x0007, {0}};
  return channel;
}

TEST(ChannelJudge, ReadsAWagoAnalogueInput) {
  const ChannelSettings channel = Wago();
  ChannelJudge judge(channel, 1.0);
  double time = 0.0;
  const auto judged = [&](std::uint16_t word) {
    time += 0.1;
    return judge.Judge(Words{word}, word, time, time);
  };
  EXPECT_EQ(judged(0x8000).value, -200.0);
  EXPECT_EQ(judged(0x0000).value, 0.0);
  EXPECT_EQ(judged(0x4000).value, 100.0);
  EXPECT_NEAR(judged(0x7FF8).value, 200.0, 0.05);  // one step of 8 below the end
  EXPECT_EQ(judged(0x7FF9).cause, Cause::kSensorFault);
  EXPECT_EQ(judged(0x8001).cause, Cause::kSensorFault);
}

TEST(ChannelJudge, WithoutItsStatusRegisterNothingIsGood) {
  const ChannelSettings channel = Wago();
  ChannelJudge judge(channel, 1.0);
  EXPECT_EQ(judge.Judge(Words{0x4000}, std::nullopt, 1.0, 1.0).cause, Cause::kSensorFault);
}

TEST(ChannelJudge, AFloatThatIsNoNumberIsBad) {
  ChannelSettings channel;
  channel.type = WordType::kFloat32;
  ChannelJudge judge(channel, 1.0);
  EXPECT_EQ(judge.Judge(Words{0x7FC0, 0}, {}, 1.0, 1.0).cause, Cause::kNotANumber);
  EXPECT_EQ(judge.Judge(Words{0x7F80, 0}, {}, 2.0, 2.0).cause, Cause::kNotANumber);
  EXPECT_EQ(judge.Judge(Words{0x4148, 0}, {}, 3.0, 3.0).value, 12.5);
}

TEST(ChannelJudge, TheEndsOfTheRangeBelongToIt) {
  ChannelSettings channel;
  channel.minimum = 10.0;
  channel.maximum = 20.0;
  ChannelJudge judge(channel, 1.0);
  double time = 0.0;
  for (const auto& [word, cause] :
       std::vector<std::pair<std::uint16_t, Cause>>{{9, Cause::kOutOfRange},
                                                    {10, Cause::kNone},
                                                    {20, Cause::kNone},
                                                    {21, Cause::kOutOfRange}}) {
    time += 1.0;
    EXPECT_EQ(judge.Judge(Words{word}, {}, time, time).cause, cause) << word;
  }
}

TEST(ChannelJudge, DiscardsWhatIsNotNewer) {
  const ChannelSettings channel;
  ChannelJudge judge(channel, 10.0);
  EXPECT_EQ(judge.Missing(Cause::kWaiting, 0.0).sequence, 0u);
  EXPECT_EQ(judge.Judge(Words{1}, {}, 1.0, 1.0).sequence, 1u);
  EXPECT_EQ(judge.Judge(Words{2}, {}, 1.0, 1.5).cause, Cause::kStale);
  EXPECT_EQ(judge.Judge(Words{2}, {}, 0.5, 1.6).cause, Cause::kStale);
  const Sample next = judge.Judge(Words{2}, {}, 1.1, 1.7);
  EXPECT_TRUE(next.good());
  EXPECT_EQ(next.sequence, 2u);
}

}  // namespace channel_judge_test
}  // namespace abbe::hal
