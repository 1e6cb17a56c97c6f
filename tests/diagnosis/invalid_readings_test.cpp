// Readings that are none, put into a table whose every other reading is known to be good.
#include "diagnosis/invalid_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "random/counter_random.h"

namespace abbe::diagnosis {
namespace invalid_readings_test {

using recording::Recording;
using testing::ElementsAreArray;

constexpr int kMoving = 100, kStanding = 60;  // rows of each motion, of the stay between them
constexpr double kNoise = 3e-6;               // rad

// A quarter of a circle, a stay, the quarter back; the pivot follows smoothly.
Recording QuarterAndBack(std::uint64_t seed = 3) {
  const random::CounterRandom random(seed, 1);
  Recording run;
  run.name = "run";
  run.header = "kind = \"linkage\"\n";
  run.columns = {
      {"time_s", {}}, {"x_mm", {}}, {"y_mm", {}}, {"pivot_1_rad", {}}, {"pivot_2_rad", {}}};
  for (int row = 0; row < 2 * kMoving + kStanding; ++row) {
    const int on_way =
        row < kMoving ? row : std::min(kMoving - 1, 2 * kMoving + kStanding - 1 - row);
    const double angle = 0.015 * on_way;
    const auto index = 2 * static_cast<std::uint64_t>(row);
    std::size_t column = 0;
    for (const double value : {0.1 * row, 20.0 * std::cos(angle), 20.0 * std::sin(angle),
                               0.3 * std::sin(angle) + kNoise * random.Normal(index),
                               0.2 * std::cos(angle) + kNoise * random.Normal(index + 1)}) {
      run.columns[column++].values.push_back(value);
    }
  }
  return run;
}

std::vector<std::size_t> Flagged(const Recording& run) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < run.rows(); ++row) {
    if (run.At("flags")[row] != 0.0) rows.push_back(row);
  }
  return rows;
}

TEST(DataIntegrity, FindsNothingInGoodReadings) {
  Recording run = QuarterAndBack();
  EXPECT_TRUE(FlagInvalidReadings(run).empty());
  EXPECT_TRUE(Flagged(run).empty());
}

// In the middle of a motion, in the stay, and where a motion begins or ends, where no row stands on
// both sides.
TEST(DataIntegrity, FindsReadingsThatJump) {
  const std::vector<std::pair<std::vector<std::size_t>, const char*>> cases{
      {{40}, "in a motion"},          {{130}, "in the stay"},         {{0}, "the first of all"},
      {{259}, "the last of all"},     {{40, 41}, "two neighbours"},   {{0, 1}, "the first two"},
      {{160, 161}, "after the stay"}, {{40, 42, 130, 200}, "several"}};
  for (const auto& [rows, where] : cases) {
    for (const double sign : {1.0, -1.0}) {
      Recording run = QuarterAndBack();
      double size = 300.0 * kNoise;
      for (const std::size_t row : rows) {
        run.columns[3].values[row] += size;
        size *= 1.6 * sign;
      }
      const auto bad = FlagInvalidReadings(run);
      EXPECT_THAT(Flagged(run), ElementsAreArray(rows)) << where << sign;
      ASSERT_EQ(bad.size(), 1u) << where;
      EXPECT_EQ(bad[0].cause, "outliers");
      EXPECT_EQ(bad[0].object, "pivot_1");
      EXPECT_EQ(bad[0].count, static_cast<int>(rows.size()));
      EXPECT_NEAR(bad[0].from, 0.1 * static_cast<double>(rows.front()), 1e-9);
      EXPECT_NEAR(bad[0].to, 0.1 * static_cast<double>(rows.back()), 1e-9);
    }
  }
}

// 40 stays of three readings, a way of 4 mm and half a second from one to the next.
Recording ShortStays() {
  const random::CounterRandom random(3, 2);
  Recording run;
  run.name = "run";
  run.header = "kind = \"sweep\"\n";
  run.columns = {{"time_s", {}}, {"x_mm", {}}, {"probe_a_um", {}}};
  for (int row = 0; row < 120; ++row) {
    const int stay = row / 3;
    run.columns[0].values.push_back(0.7 * stay + 0.05 * row);
    run.columns[1].values.push_back(4.0 * stay);
    run.columns[2].values.push_back(80.0 + 0.3 * std::sin(0.4 * stay) +
                                    0.01 * random.Normal(static_cast<std::uint64_t>(row)));
  }
  return run;
}

TEST(DataIntegrity, FindsReadingsThatJumpInStaysOfThree) {
  Recording good = ShortStays();
  EXPECT_TRUE(FlagInvalidReadings(good).empty());
  for (const std::size_t row : {30U, 31U, 32U}) {
    Recording run = ShortStays();
    run.columns[2].values[row] += 0.3;
    EXPECT_EQ(FlagInvalidReadings(run).size(), 1u);
    EXPECT_THAT(Flagged(run), ElementsAreArray({row}));
  }
}

// A channel that slips stays where it is then: each reading is one.
TEST(DataIntegrity, LeavesAStepAlone) {
  for (const std::size_t from : {50U, 51U, 140U, 200U}) {
    for (const double step : {1e-4, -3e-4}) {
      Recording run = QuarterAndBack();
      for (std::size_t row = from; row < run.rows(); ++row) run.columns[3].values[row] += step;
      EXPECT_TRUE(FlagInvalidReadings(run).empty()) << from << " " << step;
    }
  }
  // A step of twenty times the noise: three readings beside it hardly tell it from one outlier.
  for (std::uint64_t seed = 10; seed < 40; ++seed) {
    for (std::size_t from = 20; from < 80; from += 4) {
      Recording run = QuarterAndBack(seed);
      for (std::size_t row = from; row < run.rows(); ++row) {
        run.columns[3].values[row] += 20.0 * kNoise;
      }
      EXPECT_TRUE(FlagInvalidReadings(run).empty()) << seed << " " << from;
    }
  }
}

TEST(DataIntegrity, SaysNothingWithoutTimes) {
  Recording run = QuarterAndBack();
  run.columns[3].values[40] += 0.1;
  run.columns.erase(run.columns.begin());
  EXPECT_TRUE(FlagInvalidReadings(run).empty());
}

TEST(DataIntegrity, FindsAChannelThatRepeatsOneValue) {
  Recording run = QuarterAndBack();
  for (std::size_t row = 31; row < 60; ++row) {
    run.columns[4].values[row] = run.columns[4].values[30];
  }
  const auto bad = FlagInvalidReadings(run);
  ASSERT_EQ(bad.size(), 1u);
  EXPECT_EQ(bad[0].cause, "stuck-channel");
  EXPECT_EQ(bad[0].object, "pivot_2");
  EXPECT_EQ(bad[0].count, 30);
  EXPECT_EQ(Flagged(run).front(), 31u);  // the first of them was a reading
}

}  // namespace invalid_readings_test
}  // namespace abbe::diagnosis
