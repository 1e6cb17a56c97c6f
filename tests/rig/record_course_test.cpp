#include "rig/record_course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "failure/failure.h"
#include "recording/recording_file.h"
#include "rig/noise.h"
#include "rig/streams.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace record_course_test {

using Eigen::Vector3d;

LinkageRig RigOf(const RigSettings& machine, std::uint64_t seed) {
  return {World(machine, seed), Linkage(ReadLinkage(DemoMill().Root()), seed)};
}

// Standing still.
CourseState At(const Vector3d& position) {
  CourseState state{};
  state.position = position;
  state.velocity.setZero();
  return state;
}

Course Line() { return LineCourse({{0.01, 0.02, 0.03}, {0.02, 0.03, 0.04}}, 0.01, 0.0, 1); }

std::vector<double> Column(const recording::Recording& recording, const char* name) {
  const auto found = recording.Find(name);
  if (!found) throw InputError(std::string(name) + " is missing");
  return {found->begin(), found->end()};
}

double ScatterOf(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// [w X Y b Z t]: the table carries X and Y away from under the ball.
TEST(LinkageRig, APerfectMachineTakesTheBallWhereTheAxesSay) {
  const LinkageRig rig = RigOf(PerfectRig(), 1);
  const Vector3d axes(0.01, 0.02, 0.03);
  EXPECT_LT((rig.ToolAt(axes) - Vector3d(-0.01, -0.02, 0.03)).norm(), 1e-17);
  EXPECT_LT((rig.ReferenceAt(axes) - axes).norm(), 1e-17);
}

TEST(LinkageRig, AScaleErrorOfTheMachineMovesTheTip) {
  RigSettings machine = PerfectRig();
  machine.population.scale = 1e-4;
  const LinkageRig rig = RigOf(machine, 2);
  const Vector3d axes(0.05, 0.0, 0.0);
  EXPECT_GT(std::abs(rig.world().ScaleOf(0)), 1e-6);
  EXPECT_NEAR(rig.ReferenceAt(axes).x(), 0.05 * (1.0 + rig.world().ScaleOf(0)), 1e-15);
  const Vector3d perfect = RigOf(PerfectRig(), 2).EncodersAt(At(axes), 20.0, 8.5);
  EXPECT_GT((rig.EncodersAt(At(axes), 20.0, 8.5) - perfect).norm(), 1e-6);
}

TEST(LinkageRig, TheBallTrailsAgainstTheMotionWithFeedAndWithoutForce) {
  const RigSettings machine = PerfectRig();
  const LinkageRig rig = RigOf(machine, 1);
  const double half_feed = machine.cap_feed, force = machine.cap_force;
  EXPECT_EQ(rig.TrailingAt(Vector3d::Zero(), force), Vector3d::Zero().eval());
  // The table moves along +x: the ball moves along -x on it, and stays behind towards +x.
  EXPECT_DOUBLE_EQ(rig.TrailingAt({half_feed, 0.0, 0.0}, force).x(), 0.5 * machine.cap);
  EXPECT_DOUBLE_EQ(rig.TrailingAt({0.0, 0.0, half_feed}, force).z(), -0.5 * machine.cap);
  EXPECT_DOUBLE_EQ(rig.TrailingAt({half_feed, 0.0, 0.0}, 2.0 * force).x(), 0.25 * machine.cap);
  EXPECT_NEAR(rig.TrailingAt({0.0, 1e9 * half_feed, 0.0}, force).y(), machine.cap, 2e-15);
  const Vector3d slanting = rig.TrailingAt({half_feed, half_feed, 0.0}, force);
  EXPECT_DOUBLE_EQ(slanting.x(), slanting.y());
}

TEST(LinkageRig, TheSameSeedGivesTheSameRecordingAndARunOnlyOtherNoise) {
  const LinkageRig rig = RigOf(DemoRig(), 7);
  const auto first = rig.Record(Line(), {.reference = true});
  const auto again = RigOf(DemoRig(), 7).Record(Line(), {.reference = true});
  const auto other = rig.Record(Line(), {.reference = true, .run = 2});
  ASSERT_GT(first.rows(), 100U);
  for (std::size_t i = 0; i < first.columns.size(); ++i) {
    EXPECT_EQ(first.columns[i].values, again.columns[i].values) << first.columns[i].name;
  }
  EXPECT_EQ(Column(first, "x_mm"), Column(other, "x_mm"));
  // Two draws each, 4 / sqrt(2 n) of it for the scatter of n rows.
  const double share = 4.0 / std::sqrt(2.0 * static_cast<double>(first.rows()));
  const double reference = std::sqrt(2.0) * 0.3e-3;  // mm
  EXPECT_NEAR(ScatterOf(Column(first, "ref_y_mm"), Column(other, "ref_y_mm")), reference,
              share * reference);
  // And what a count rounds: 2 pi / 2^22 / sqrt(12) = 0.4 urad. The temperature of another run
  // moves the ends of the links by 0.1 K * 11.5 ppm, 1 urad of the links; the middle of it is taken
  // off.
  const auto angles = Column(first, "pivot_2_rad"), others = Column(other, "pivot_2_rad");
  EXPECT_GT(ScatterOf(angles, others), 3e-6);
  EXPECT_LT(ScatterOf(angles, others), 7e-6);
  const auto stranger = RigOf(DemoRig(), 8).Record(Line(), {.reference = true});
  EXPECT_GT(ScatterOf(angles, Column(stranger, "pivot_2_rad")), 5e-5);
}

TEST(LinkageRig, TheBallSitsElsewhereInEachStayAndStillInOne) {
  constexpr double kSeat = 3e-6;
  constexpr int kStays = 4000;
  BallSeat seat(1, kBallStream, kSeat);
  double squares = 0.0;
  for (int stay = 0; stay < kStays; ++stay) {
    const Vector3d axes(0.001 * stay, 0.0, 0.0);
    const Vector3d there = seat.At(axes);
    EXPECT_EQ(seat.At(axes + Vector3d::Constant(1e-7)), there);
    squares += there.squaredNorm();
  }
  // A variance of 3 n normal numbers: four standard deviations.
  const double count = 3.0 * kStays;
  EXPECT_NEAR(squares / count / (kSeat * kSeat), 1.0, 4.0 * std::sqrt(2.0 / count));

  // In a recording: the angles of two stays at one place.
  LinkageSettings settings = ReadLinkage(DemoMill().Root());
  settings.encoder_noise = 0.0;
  settings.repeatability = 0.1e-3;
  const Vector3d here(0.03, 0.03, 0.03), there(0.04, 0.03, 0.03);
  const auto course = DwellCourse({here, there, here}, 0.1, 0.1, 1);
  const LinkageRig rig(World(PerfectRig(), 1), Linkage(settings, 1));
  const auto angles = Column(rig.Record(course), "pivot_2_rad");
  EXPECT_NEAR(angles[0], angles[2], 1e-5);  // 0.1 um of arriving, a count
  EXPECT_GT(std::abs(angles.front() - angles.back()), 1e-5);
}

TEST(LinkageRig, AnglesDoNotJumpByATurn) {
  // Along x pivot 3 of the demonstration machine passes pi.
  const Course course = LineCourse({{0.0, 0.03, 0.03}, {0.06, 0.03, 0.03}}, 0.02, 0.0, 1);
  const auto angles = Column(RigOf(DemoRig(), 1).Record(course), "pivot_3_rad");
  double least = 10.0, most = -10.0;
  for (std::size_t i = 1; i < angles.size(); ++i) {
    ASSERT_LT(std::abs(angles[i] - angles[i - 1]), 0.1) << i;
    least = std::min(least, std::abs(angles[i]));
    most = std::max(most, std::abs(angles[i]));
  }
  EXPECT_LT(least, std::numbers::pi);
  EXPECT_GT(most, std::numbers::pi);
}

TEST(LinkageRig, WritesRecordingsThatReadBack) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "rig_linkage.csv";
  const LinkageRig rig = RigOf(DemoRig(), 3);
  for (const char* kind : {"linkage", "reference"}) {
    const auto made = rig.Record(Line(), {.kind = kind, .rate = 20.0});
    std::filesystem::remove(path);
    recording::Write(made, path);
    const auto read = recording::Read(path);
    EXPECT_EQ(read.Kind(), kind);
    EXPECT_TRUE(read.warnings.empty());
    ASSERT_EQ(read.columns.size(), made.columns.size());
    for (std::size_t i = 0; i < made.columns.size(); ++i) {
      EXPECT_EQ(read.columns[i].values, made.columns[i].values) << made.columns[i].name;
    }
  }
  std::filesystem::remove(path);
}

TEST(LinkageRig, RefusesAnUnknownKindAndARateAboveTheSensors) {
  const LinkageRig rig = RigOf(DemoRig(), 3);
  EXPECT_THROW(rig.Record(Line(), {.kind = "sweep"}), InputError);
  EXPECT_THROW(rig.Record(Line(), {.rate = 2000.0}), InputError);
  EXPECT_THROW(rig.Record(Line(), {.rate = 0.0}), InputError);
}

}  // namespace record_course_test
}  // namespace abbe::rig
