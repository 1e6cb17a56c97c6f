#include "hal/can/encoder_judge.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace abbe::hal {
namespace encoder_judge_test {

EncoderSettings Encoder() {
  EncoderSettings encoder;
  encoder.name = "pivot_1_rad";
  encoder.counts_per_turn = 4096;
  encoder.range = 4096;
  encoder.fastest = 10.0;
  return encoder;
}

Sample At(EncoderJudge& judge, std::int64_t count, double time_s) {
  return judge.Judge(count, time_s, time_s);
}

// A steady turn either way, through the end of the range: the angle goes on without a step.
RC_GTEST_PROP(EncoderJudge, FollowsThroughTheEndOfItsRange, ()) {
  EncoderSettings encoder = Encoder();
  encoder.is_signed = *rc::gen::arbitrary<bool>();
  encoder.sense = *rc::gen::element(1, -1);
  encoder.range = 4096 * *rc::gen::inRange(1, 4);
  encoder.zero = *rc::gen::inRange(-9000, 9000);
  EncoderJudge judge(encoder, 1.0);
  const double speed = *rc::gen::inRange(-900, 900) * 0.01;
  const double start = *rc::gen::inRange(-314, 314) * 0.01;
  for (int i = 0; i < 400; ++i) {
    const double time = 0.01 * i, angle = start + speed * time;
    const Sample sample = At(judge, CountOf(encoder, angle), time);
    RC_ASSERT(sample.good());
    // Half a count: the encoder's own rounding.
    RC_ASSERT(std::abs(sample.value - angle) <= 0.5 * encoder.Step() + 1e-9);
  }
}

TEST(EncoderJudge, AJumpIsBadAndForgotten) {
  EncoderJudge judge(Encoder(), 1.0);
  const double before = At(judge, 100, 0.0).value;
  const Sample jump = At(judge, 2100, 0.01);
  EXPECT_EQ(jump.cause, Cause::kJump);
  EXPECT_TRUE(std::isnan(jump.value));
  const Sample after = At(judge, 101, 0.02);
  EXPECT_TRUE(after.good());
  EXPECT_NEAR(after.value - before, Encoder().Step(), 1e-12);
}

TEST(EncoderJudge, AJumpThatStaysMeansANewZero) {
  EncoderJudge judge(Encoder(), 1.0);
  At(judge, 100, 0.0);
  EXPECT_EQ(At(judge, 2100, 0.01).cause, Cause::kJump);
  EXPECT_EQ(At(judge, 2101, 0.02).cause, Cause::kJump);
  EXPECT_EQ(At(judge, 2102, 0.03).cause, Cause::kJump);
  EXPECT_TRUE(judge.reference_lost());
  // Even where it was before, and long after a motion there would have been possible.
  EXPECT_EQ(At(judge, 100, 0.04).cause, Cause::kReferenceLost);
  EXPECT_EQ(At(judge, 2103, 10.0).cause, Cause::kReferenceLost);
  judge.ConfirmReference();
  const Sample confirmed = At(judge, 4096 - 5, 10.1);
  EXPECT_TRUE(confirmed.good());
  EXPECT_NEAR(confirmed.value, -5 * Encoder().Step(), 1e-12);
}

TEST(EncoderJudge, WildCountsThatDoNotAgreeAreNoNewZero) {
  EncoderJudge judge(Encoder(), 1.0);
  At(judge, 100, 0.0);
  for (int i = 1; i < 10; ++i) {
    EXPECT_EQ(At(judge, i % 2 == 0 ? 1500 : 2800, 0.001 * i).cause, Cause::kJump);
  }
  EXPECT_FALSE(judge.reference_lost());
}

TEST(EncoderJudge, OutOfRangeStaleFrozenAndTwice) {
  EncoderSettings encoder = Encoder();
  EncoderJudge judge(encoder, 1.0);
  EXPECT_EQ(At(judge, 4096, 0.1).cause, Cause::kOutOfRange);
  EXPECT_EQ(At(judge, -1, 0.2).cause, Cause::kOutOfRange);
  EXPECT_EQ(judge.Judge(5, 0.3, 1.4).cause, Cause::kStale);
  EXPECT_EQ(judge.Judge(5, 0.3, 1.4).cause, Cause::kStale);  // the same again
  EXPECT_TRUE(At(judge, 5, 1.5).good());
  EXPECT_TRUE(At(judge, 5, 9.0).good());  // an encoder may stand

  encoder.may_freeze = false;
  EncoderJudge strict(encoder, 1.0);
  EXPECT_TRUE(At(strict, 5, 0.0).good());
  EXPECT_TRUE(At(strict, 5, 0.9).good());
  EXPECT_EQ(At(strict, 5, 1.1).cause, Cause::kFrozen);
  EXPECT_TRUE(At(strict, 6, 1.2).good());
}

}  // namespace encoder_judge_test
}  // namespace abbe::hal
