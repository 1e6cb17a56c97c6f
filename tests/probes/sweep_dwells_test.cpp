#include "probes/sweep_dwells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "failure/failure.h"
#include "tests/probes/synthetic_sweep.h"

namespace abbe::probes {
namespace sweep_dwells_test {

constexpr PerProbe<> kRanges = {200e-6, 200e-6, 200e-6, 200e-6, 200e-6};

std::vector<double>& ColumnOf(recording::Recording& recording, const std::string& name) {
  for (recording::Column& column : recording.columns) {
    if (column.name == name) return column.values;
  }
  throw std::logic_error(name);
}

SweepDwells Find(const recording::Recording& recording) {
  return FindDwells(recording, DwellRuleOf(recording), kRanges);
}

std::string RefusalOf(const recording::Recording& recording) {
  try {
    Find(recording);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SweepDwells, OneDwellForEachVisitAndEveryRowCountedOnce) {
  const SyntheticSweep sweep{.stations = 4, .passes = 3};
  const SweepDwells found = Find(Record(sweep, TestSetup()));
  EXPECT_EQ(found.axis, 'X');
  ASSERT_EQ(found.dwells.size(), 4U * 2 * 3);
  ASSERT_EQ(found.stations.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(found.stations[i], 5e-3 * i, 1e-12);
  // 12 rows on the way and 20 of 100 ms settling to each dwell of 60. The last row on the way is 50
  // um from the station, outside the window.
  for (const Dwell& dwell : found.dwells) EXPECT_NEAR(dwell.samples, 60, 1);
  EXPECT_EQ(found.dwells.front().direction, +1);
  EXPECT_EQ(found.dwells[4].direction, -1);
  EXPECT_EQ(found.dwells[4].station, 3U);
  EXPECT_EQ(found.dwells.back().pass, 3);
  const SampleCounts& counts = found.counts;
  EXPECT_EQ(counts.rows, 24U * 92);
  EXPECT_EQ(counts.used + counts.flagged + counts.moving, counts.rows);
}

TEST(SweepDwells, FlaggedRowsAndNaNAreLeftOutAndCounted) {
  recording::Recording recording = Record({.stations = 4, .passes = 1}, TestSetup());
  ColumnOf(recording, "flags")[50] = 2.0;
  ColumnOf(recording, "probe_c_um")[50] = 1e9;
  ColumnOf(recording, "flags")[60] = 1.0;
  ColumnOf(recording, "probe_e_um")[70] = std::numeric_limits<double>::quiet_NaN();
  const SweepDwells found = Find(recording);
  EXPECT_EQ(found.counts.flagged, 3U);
  EXPECT_NEAR(found.dwells.front().samples, 57, 1);
  EXPECT_NEAR(found.dwells.front().gap[2], found.dwells[7].gap[2], 1e-12);
}

TEST(SweepDwells, AnImpossibleGapIsRefusedWithRowProbeValueAndRange) {
  for (const double gap : {-0.5, 200.5}) {
    recording::Recording recording = Record({.stations = 4, .passes = 1}, TestSetup());
    ColumnOf(recording, "probe_d_um")[16] = gap;
    EXPECT_THAT(
        RefusalOf(recording),
        testing::AllOf(testing::HasSubstr("synthetic_X.csv: row 17: "),
                       testing::HasSubstr("probe_d_um"), testing::HasSubstr(fmt::format("{}", gap)),
                       testing::HasSubstr("0 to 200 um")));
    ColumnOf(recording, "flags")[16] = 2.0;
    EXPECT_EQ(RefusalOf(recording), "accepted");
  }
}

TEST(SweepDwells, ShortStopsAreNoDwells) {
  const recording::Recording whole = Record({.stations = 4, .passes = 1}, TestSetup());
  recording::Recording recording = whole;
  // The axis also stops for 120 ms beyond its last station, where it turns.
  for (recording::Column& column : recording.columns) {
    const double last = column.values.back();
    for (int i = 1; i <= 24; ++i) {
      double value = last;
      if (column.name == "time_s") value += 0.005 * i;
      if (column.name == "x_mm") value = -0.5;
      column.values.push_back(value);
    }
  }
  const SweepDwells found = Find(recording);
  EXPECT_EQ(found.dwells.size(), Find(whole).dwells.size());
  EXPECT_EQ(found.counts.used + found.counts.moving, found.counts.rows);
}

TEST(SweepDwells, AnOutlierHardlyPullsAndIsCounted) {
  const SyntheticSweep sweep{.stations = 4, .passes = 1, .white = 20e-9};
  recording::Recording recording = Record(sweep, TestSetup());
  const SweepDwells before = Find(recording);
  ColumnOf(recording, "probe_a_um")[60] += 5.0;
  const SweepDwells after = Find(recording);
  EXPECT_EQ(after.counts.outliers, before.counts.outliers + 1);
  // Huber: no value pulls with more than k = 2 scales, 2 * 20 nm / 60; the plain mean gives 83 nm.
  EXPECT_NEAR(after.dwells[0].gap[0], before.dwells[0].gap[0], 1.5 * 2 * 20e-9 / 60);
}

// The deviation of a dwell of a dozen readings is hardly known from itself: by it alone 0.5 % of
// good readings lie beyond 4 of it, beside 0.006 % beyond 4 of the true one.
TEST(SweepDwells, ShortDwellsHaveNoOutliersOfTheirOwn) {
  const SyntheticSweep sweep{.stations = 21, .passes = 3, .samples = 13, .white = 20e-9, .seed = 2};
  const SweepDwells found = Find(Record(sweep, TestSetup()));
  ASSERT_EQ(found.dwells.size(), 126U);
  EXPECT_LE(found.counts.outliers, 4U);  // expected: 126 * 5 * 13 * 6e-5 = 0.4
}

TEST(SweepDwells, WithoutAColumnFlagsEveryRowIsGood) {
  const recording::Recording whole = Record({.stations = 4, .passes = 1}, TestSetup());
  recording::Recording recording = whole;
  std::erase_if(recording.columns, [](const auto& column) { return column.name == "flags"; });
  ASSERT_FALSE(recording.Find("flags"));
  const SweepDwells found = Find(recording);
  EXPECT_EQ(found.counts.used, Find(whole).counts.used);
  EXPECT_EQ(found.counts.flagged, 0U);
}

TEST(SweepDwells, WhiteNoiseIsFoundAsItIs) {
  const SweepDwells found = Find(Record({.white = 20e-9, .seed = 5}, TestSetup()));
  for (const Scatter& scatter : found.scatter) {
    // 130 dwells of 60: relative standard deviation 1 / sqrt(2 dof), of the correlation 1 /
    // sqrt(dof).
    EXPECT_NEAR(scatter.dof, 130 * 59, 140);
    EXPECT_NEAR(scatter.white, 20e-9, 4 * 20e-9 / std::sqrt(2 * scatter.dof));
    EXPECT_NEAR(scatter.lag1, 0.0, 4 / std::sqrt(scatter.dof));
  }
}

TEST(SweepDwells, TheHeaderSetsWindowAndSettling) {
  recording::Recording recording = Record({.stations = 4, .passes = 1}, TestSetup());
  recording.header += "[sweep]\nwindow_um = 10.0\nsettle_s = 0.2\n";
  const DwellRule rule = DwellRuleOf(recording);
  EXPECT_DOUBLE_EQ(rule.window, 10e-6);
  EXPECT_DOUBLE_EQ(rule.settle, 0.2);
  EXPECT_NEAR(Find(recording).dwells.front().samples, 40, 1);
}

TEST(SweepDwells, WhatIsNoSweepIsRefused) {
  recording::Recording recording = Record({.stations = 4, .passes = 1}, TestSetup());
  const std::string header = recording.header;
  recording.header = "kind = \"dwell\"\n";
  EXPECT_THAT(RefusalOf(recording), testing::HasSubstr("kind is \"dwell\""));
  recording.header = "kind = \"sweep\"\n";
  EXPECT_THAT(RefusalOf(recording), testing::HasSubstr("name its axis"));
  recording.header = header + "[sweep]\nsettle_s = 9.0\n";
  EXPECT_THAT(RefusalOf(recording), testing::HasSubstr("no dwell found"));
  recording.header = header + "[sweep]\nsettle_s = \"long\"\n";
  EXPECT_THAT(RefusalOf(recording), testing::HasSubstr("sweep.settle_s"));
  recording.header = header;
  recording.columns.erase(recording.columns.begin() + 9);
  EXPECT_THAT(RefusalOf(recording), testing::HasSubstr("probe_c_um"));
}

}  // namespace sweep_dwells_test
}  // namespace abbe::probes
