// Positioning tests as runs: what is read, their noise by hand, which way they head.
#include "simulation/points/reference_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "simulation/points/reference_noise.h"
#include "simulation/points/reference_trace.h"

namespace abbe::simulation {
namespace reference_run_test {

constexpr int kTargets = 9, kCycles = 5;
constexpr double kMicro = 1e-6;

// Deviation of a reading, um.
using Deviation = std::function<double(int target, int direction, int cycle, int row)>;

recording::Recording TestOf(const Deviation& deviation, const std::string& more = "") {
  recording::Recording test;
  test.name = "test.csv";
  test.header = "kind = \"reference\"\naxis = \"X\"\n" + more;
  test.columns = {{"time_s", {}}, {"x_mm", {}}, {"pass", {}}, {"direction", {}}, {"ref_x_mm", {}}};
  int row = 0;
  for (int cycle = 1; cycle <= kCycles; ++cycle) {
    for (const int direction : {1, -1}) {
      for (int i = 0; i < kTargets; ++i, ++row) {
        const int target = direction > 0 ? i : kTargets - 1 - i;
        const double at = 5.0 * target;
        const double off = 1e-3 * deviation(target, direction, cycle, row);
        const double values[] = {static_cast<double>(row), at, static_cast<double>(cycle),
                                 static_cast<double>(direction), at + off};
        for (std::size_t c = 0; c < std::size(values); ++c)
          test.columns[c].values.push_back(values[c]);
      }
    }
  }
  return test;
}

double Noise(int row) {
  const random::CounterRandom random(3, 1);
  return random.Normal(static_cast<std::uint64_t>(row));
}

ReferenceRun RunOf(const recording::Recording& recording) {
  const machine::Travel travel{0.0, 0.1};
  return MeansOfStays(ReadReferenceRun(WithAllAxes(recording, {travel, travel, travel})));
}

TEST(ReferenceNoise, IsThatOfTheReadings) {
  const auto noise =
      NoiseOfRepeats(RunOf(TestOf([](int, int, int, int row) { return Noise(row); })));
  ASSERT_TRUE(noise);
  // In each direction a mean of each target, and offset and slope of all cycles but one.
  EXPECT_EQ(noise->freedom, 2 * (kTargets - 2) * (kCycles - 1));
  // 99.99 % of a chi-square of 56 degrees.
  EXPECT_NEAR(noise->sd[0], kMicro, 3.9 / std::sqrt(2.0 * 56.0) * kMicro);
  EXPECT_EQ(noise->sd[1], 0.0);
}

TEST(ReferenceNoise, IsNotReversalErrorDriftOrGrowth) {
  const auto plain =
      NoiseOfRepeats(RunOf(TestOf([](int, int, int, int row) { return Noise(row); })));
  const auto other = NoiseOfRepeats(RunOf(TestOf([](int target, int direction, int cycle, int row) {
    return Noise(row) + 30.0 * std::sin(target) + 20.0 * direction * target + 15.0 * cycle * cycle +
           3.0 * cycle * target * direction;
  })));
  EXPECT_NEAR(other->sd[0], plain->sd[0], 1e-12);
}

TEST(ReferenceNoise, IsUnknownWithoutRepeats) {
  auto once = TestOf([](int, int, int, int row) { return Noise(row); });
  for (auto& column : once.columns) column.values.resize(2 * kTargets);
  EXPECT_FALSE(NoiseOfRepeats(RunOf(once)));
  const auto exact = RunOf(TestOf([](int target, int, int, int) { return target; }));
  EXPECT_THROW(NoiseOfRepeats(exact), InputError);
}

TEST(ReferenceRun, TakesTheNoiseThatIsStated) {
  const auto none = [](int, int, int, int) { return 0.0; };
  EXPECT_EQ(RunOf(TestOf(none)).sd(0, 0), 0.0);
  ReferenceRun stated = RunOf(TestOf(none, "u_reference_um = 0.5\n"));
  EXPECT_DOUBLE_EQ(stated.sd(0, 3), 0.5 * kMicro);
  SetNoise(Eigen::Vector3d::Constant(kMicro), stated);
  EXPECT_DOUBLE_EQ(stated.sd(0, 3), 0.5 * kMicro);
  EXPECT_THROW(RunOf(TestOf(none, "u_reference_um = 0\n")), InputError);
  EXPECT_DOUBLE_EQ(stated.u_scale, 0.0);
  EXPECT_DOUBLE_EQ(RunOf(TestOf(none, "u_scale_ppm = 5\n")).u_scale, 5e-6);
  EXPECT_THROW(RunOf(TestOf(none, "u_scale_ppm = -5\n")), InputError);
}

TEST(ReferenceRun, KnowsTheTestedAxisAndItsTime) {
  const auto none = [](int, int, int, int) { return 0.0; };
  EXPECT_EQ(RunOf(TestOf(none)).tested, 'X');
  EXPECT_TRUE(RunOf(TestOf(none)).timed);
  EXPECT_FALSE(RunOf(TestOf(none, "time = \"order\"\n")).timed);
  auto moves = TestOf(none);
  moves.columns.push_back({"y_mm", moves.columns[1].values});
  EXPECT_EQ(RunOf(moves).tested, ' ');
}

TEST(ReferenceRun, MeansReadingsOfOneApproach) {
  auto doubled = TestOf([](int, int, int, int row) { return row; });
  for (auto& column : doubled.columns) {
    std::vector<double> twice;
    for (const double value : column.values) twice.insert(twice.end(), {value, value});
    column.values = twice;
  }
  doubled.columns[4].values[1] += 2e-3;
  const ReferenceRun run = RunOf(doubled);
  // The last target of one way is the first of the next: two approaches.
  ASSERT_EQ(run.rows(), 2 * kTargets * kCycles);
  EXPECT_NEAR(run.place(0, 0), kMicro, 1e-15);
  EXPECT_EQ(run.points.rows[1], 2U);
  EXPECT_EQ(Thinned(run, 45).rows(), 45);
}

TEST(ReferenceTrace, HeadsAsEachTargetWasApproached) {
  const auto test = TestOf([](int, int, int, int) { return 0.0; });
  const ReferenceRun run = RunOf(test);
  const Trace trace = TraceOf(test, run);
  for (Eigen::Index row = 0; row < trace.rows(); ++row) {
    EXPECT_EQ(trace.heading(0, row), run.direction[static_cast<std::size_t>(row)]);
    EXPECT_EQ(trace.BacklashLag(0, 10e-6)[row], -0.5 * trace.heading(0, row));
  }
  EXPECT_TRUE(trace.velocity.isZero(0.0));
  EXPECT_TRUE((trace.since_reversal.array() == kLongAgo).all());
}

// To and fro by 0.1 mm a row, read on the way.
TEST(ReferenceTrace, TakesUpAPlayWhileTheAxisMoves) {
  recording::Recording course;
  course.name = "line.csv";
  course.header = "kind = \"reference\"\n";
  course.columns = {
      {"time_s", {}}, {"x_mm", {}}, {"pass", {}}, {"direction", {}}, {"ref_x_mm", {}}};
  for (int row = 0; row < 40; ++row) {
    const double at = 0.1 * (row < 20 ? row : 40 - row);
    const double values[] = {0.1 * row, at, 1.0, 1.0, at};
    for (std::size_t c = 0; c < std::size(values); ++c)
      course.columns[c].values.push_back(values[c]);
  }
  const Trace trace = TraceOf(course, RunOf(course));
  const double width = 0.25e-3;
  const Eigen::RowVectorXd behind = trace.BacklashLag(0, width);
  EXPECT_NEAR(behind[19], -0.5, 1e-12);
  EXPECT_NEAR(behind[21], -0.5 + 0.1e-3 / width, 1e-12);
  EXPECT_NEAR(behind[22], -0.5 + 0.2e-3 / width, 1e-12);
  EXPECT_NEAR(behind[23], 0.5, 1e-12);
  // A tenth of the place wide. At the turn, 2 mm, the output stands at 1.9 mm, where the input comes
  // next.
  const Eigen::RowVectorXd varying = trace.BacklashLag(0, [](double at) { return 0.1 * at; });
  EXPECT_NEAR(varying[20], -0.5, 1e-12);
  EXPECT_NEAR(varying[21], 0.0, 1e-12);
  EXPECT_NEAR(varying[22], 0.5, 1e-12);
}

TEST(ReferenceTrace, BeginsItsOwnClockWhereItDoesNotSayWhen) {
  const auto none = [](int, int, int, int) { return 0.0; };
  const auto plain = TestOf(none), early = TestOf(none, "started = \"2026-11-21T09:00:00Z\"\n"),
             late = TestOf(none, "started = \"2026-11-21T09:10:00Z\"\n");
  std::vector<Trace> traces{TraceOf(late, RunOf(late)), TraceOf(plain, RunOf(plain)),
                            TraceOf(early, RunOf(early))};
  const Origin origin = OriginOf({&traces[0], &traces[1], &traces[2]});
  for (Trace& trace : traces) CountFrom(origin, trace);
  EXPECT_EQ(traces[0].clock[3], 603.0);
  EXPECT_EQ(traces[1].clock[3], 3.0);
  EXPECT_EQ(traces[2].clock[3], 3.0);
}

}  // namespace reference_run_test
}  // namespace abbe::simulation
