#include "rig/live_machine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/rig/hidden_worlds.h"

namespace abbe::rig {
namespace live_machine_test {

const Eigen::Vector3d kCentre = Eigen::Vector3d::Constant(0.03);

class Running : public testing::Test {
 protected:
  double now_ = 0.0;
  const World world_{DemoRig(), 3};
  const Course course_ = CircleCourse({.centre = kCentre, .radius = 0.01, .feed = 0.02});
  LiveMachine machine_{world_, [this] { return now_; }, nullptr, course_};
};

// Every 1 ms from rest: the axes never jump, the passes are the full turns of both senses.
TEST_F(Running, ACourseGoesFromRestRoundBothWaysAndBackToRest) {
  ASSERT_EQ(machine_.Start(kCourseProgram), StartOutcome::kStarted);
  EXPECT_EQ(machine_.Start(0), StartOutcome::kBusy);
  Eigen::Vector3d before = machine_.Now().axes.position;
  EXPECT_EQ(before, Eigen::Vector3d::Zero());
  double turned[2] = {};
  Moment moment = machine_.Now();
  for (; moment.state == ProgramState::kRunning && now_ < 60.0; moment = machine_.Now()) {
    const Eigen::Vector3d& position = moment.axes.position;
    ASSERT_LT((position - before).norm(), 0.06e-3);  // rapid: 50 mm/s
    const double pass = *machine_.ReadingOf("pass", moment);
    const double direction = *machine_.ReadingOf("direction", moment);
    EXPECT_EQ(pass, std::abs(direction));
    EXPECT_NEAR(*machine_.ReadingOf("feed_mm_min", moment), pass * 1200.0, 1e-9);
    if (pass == 1.0) {
      // Its own radius is smaller by the lag: R / sqrt(1 + (v lag / R)^2).
      const Eigen::Vector3d arm = position - kCentre, arm_before = before - kCentre;
      EXPECT_NEAR(arm.norm(), 0.01 / std::hypot(1.0, 0.02 * 0.015 / 0.01), 0.1e-6);
      turned[direction > 0.0 ? 0 : 1] += std::atan2(arm_before.cross(arm).z(), arm_before.dot(arm));
    }
    before = position;
    now_ += 1e-3;
  }
  // A full turn of each sense, but for one step.
  EXPECT_NEAR(turned[0], 2.0 * M_PI, 0.003);
  EXPECT_NEAR(turned[1], -2.0 * M_PI, 0.003);
  EXPECT_EQ(moment.state, ProgramState::kDone);
  EXPECT_EQ(moment.axes.position, Eigen::Vector3d::Zero());
  EXPECT_LT(before.norm(), 1e-6);
  EXPECT_EQ(machine_.Start(kCourseProgram), StartOutcome::kStarted);
}

TEST_F(Running, ASensorShowsTheSameUntilItsNextUpdate) {
  ASSERT_EQ(machine_.Start(kCourseProgram), StartOutcome::kStarted);
  now_ = 0.7001;
  const Moment first = machine_.Now();
  now_ = 0.7009;
  EXPECT_EQ(machine_.Now().axes.position, first.axes.position);
  now_ = 0.7011;
  EXPECT_NE(machine_.Now().axes.position, first.axes.position);
  now_ = 0.2;  // another reader was quicker
  EXPECT_EQ(machine_.Now().tick, 701u);
}

TEST_F(Running, WithoutACourseThereIsNoFourthProgram) {
  LiveMachine machine(world_, [] { return 0.0; });
  EXPECT_EQ(machine.Start(kCourseProgram), StartOutcome::kNoSuchProgram);
  EXPECT_EQ(machine.Start(-1), StartOutcome::kNoSuchProgram);
  EXPECT_FALSE(machine.EncodersNow());
}

TEST_F(Running, ACourseOutOfTheLinkagesReachIsRefused) {
  LinkageSettings far = ReadLinkage(DemoMill().Root());
  far.base_position.x() -= 0.3;
  const LinkageRig linkage(world_, Linkage(far, 3));
  EXPECT_THROW(LiveMachine(
                   world_, [] { return 0.0; }, &linkage, course_),
               InputError);
}

// With nothing wrong but what is hidden, every 10 ms through a circle.
TEST(LiveMachine, BacklashActsOnWhatTheEncodersShow) {
  double now = 0.0;
  const LinkageRig rig = PerfectLinkageRig(Hide({"backlash:object=X:width_um=6"}));
  LiveMachine machine(
      rig.world(), [&] { return now; }, &rig,
      CircleCourse({.centre = kCentre, .radius = 0.01, .feed = 0.02}));
  machine.Start(kCourseProgram);
  int checked = 0;
  double before = 0.0, way = 0.0;  // m, since the axis turned
  for (; now < 30.0 && machine.Now().state == ProgramState::kRunning; now += 0.01) {
    const Eigen::Vector3d position = machine.Now().axes.position;
    const double step = position.x() - before;
    before = position.x();
    way = way * step >= 0.0 ? way + step : step;
    if (std::abs(way) < 1e-3 || std::abs(step) < 1e-6) continue;  // about to turn, or just has
    const double x = position.x() - (way > 0.0 ? 3e-6 : -3e-6);
    const Eigen::Vector3d ball(-x, -position.y(), position.z());
    const Eigen::Vector3d expected = rig.linkage().EncodersFor(ball, 20.0);
    const Eigen::Vector3d shown = *machine.EncodersNow();
    for (int i = 0; i < kPivots; ++i) {
      EXPECT_NEAR(std::remainder(shown[i] - expected[i], 2.0 * M_PI), 0.0, 1e-11);
    }
    ++checked;
  }
  EXPECT_GT(checked, 500);
}

// What happens between two readings does not depend on who reads.
TEST(LiveMachine, HiddenHistoryDoesNotDependOnTheReader) {
  const LinkageRig rig = PerfectLinkageRig(
      Hide({"reversal-spike:object=X:height_um=5:decay_mm=2", "backlash:object=X:width_um=4"}));
  double now = 0.0;
  const auto time = [&] { return now; };
  LiveMachine often(rig.world(), time, &rig), rarely(rig.world(), time, &rig);
  often.Start(0);
  rarely.Start(0);
  for (int i = 0; i < 4000; ++i, now += 0.025) {
    const Eigen::Vector3d shown = *often.EncodersNow();
    if (i % 80 != 79) continue;
    // The spike by 5 um / 2 mm of what the axis moves in the 5 ms of a step.
    EXPECT_LT((*rarely.EncodersNow() - shown).norm(), 2e-6) << now;
  }
}

TEST(LiveMachine, AProbeWarmsUpSinceTheRigIsOn) {
  const World world(PerfectMachine(), 1,
                    Hide({"warm-up-drift:object=probe_b:amplitude_um=2:time_constant_s=100"}));
  double now = 0.0;
  LiveMachine machine(world, [&] { return now; });
  for (now = 20.0; now < 300.0; now += 40.0) {
    EXPECT_NEAR(*machine.ReadingOf("probe_b_um", machine.Now()),
                100.0 + 2.0 * (1.0 - std::exp(-now / 100.0)), 1e-6);
    EXPECT_NEAR(*machine.ReadingOf("probe_a_um", machine.Now()), 100.0, 1e-6);
  }
}

TEST_F(Running, AJogMovesAnAxisByHand) {
  machine_.Jog(1, 0.02);
  now_ = 0.1;  // 50 mm/s
  EXPECT_NEAR(machine_.Now().axes.position.y(), 0.005, 1e-9);
  now_ = 1.0;
  EXPECT_EQ(machine_.Now().axes.position, Eigen::Vector3d(0.0, 0.02, 0.0));
  EXPECT_THROW(machine_.Jog(1, 0.07), InputError);
  ASSERT_EQ(machine_.Start(0), StartOutcome::kStarted);
  EXPECT_THROW(machine_.Jog(1, 0.01), InputError);
}

// The three screws under the target, a quarter of a turn of 0.25 mm: the top gaps close by that.
TEST_F(Running, ScrewsRaiseTheTarget) {
  const auto gap = [&](const char* probe) {
    double sum = 0.0;  // of many updates: noise of 20 nm
    for (int i = 0; i < 400; ++i) {
      now_ += 2e-3;
      sum += *machine_.ReadingOf(probe, machine_.Now()) / 400.0;
    }
    return sum;
  };
  const double top = gap("probe_b_um"), side = gap("probe_d_um");
  for (const char* screw : {"base_left", "base_right", "base_back"}) machine_.Turn(screw, 0.25);
  EXPECT_NEAR(gap("probe_b_um") - top, -62.5, 0.2);
  EXPECT_NEAR(gap("probe_d_um") - side, 0.0, 0.2);
  EXPECT_THROW(machine_.Turn("top", 1.0), InputError);
}

}  // namespace live_machine_test
}  // namespace abbe::rig
