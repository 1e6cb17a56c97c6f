// Channels that freeze for part of a sweep.
#include "probes/frozen_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"
#include "tests/probes/changed_sweep.h"

namespace abbe::probes {
namespace frozen_readings_test {

// Dwells of ten readings with noise of 1, rounded to steps; the mean moves on from dwell to dwell.
std::vector<DwellReadings> DwellsOf(double step, std::size_t count, double moves) {
  const random::CounterRandom random(7, 1);
  std::vector<DwellReadings> dwells(count);
  std::uint64_t index = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 10; ++k) {
      const double reading = 100.0 + moves * static_cast<double>(i) + random.Normal(index++);
      dwells[i].Add(step > 0.0 ? step * std::round(reading / step) : reading);
    }
  }
  return dwells;
}

DwellReadings Still(double reading) {
  DwellReadings dwell;
  for (int k = 0; k < 10; ++k) dwell.Add(reading);
  return dwell;
}

TEST(FrozenReadings, AreFoundBesideNoise) {
  std::vector<DwellReadings> dwells = DwellsOf(0.0, 40, 0.1);
  EXPECT_TRUE(FindFrozen(dwells).empty());
  const double last = dwells[9].last();
  for (std::size_t i = 10; i < 14; ++i) dwells[i] = Still(last);
  const std::vector<FrozenRun> runs = FindFrozen(dwells);
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].first, 9U);  // it froze within this dwell
  EXPECT_EQ(runs[0].last, 13U);
  EXPECT_DOUBLE_EQ(runs[0].reading, last);
}

TEST(FrozenReadings, OneDwellAloneOrAnotherReadingInEachIsNone) {
  std::vector<DwellReadings> dwells = DwellsOf(0.0, 40, 0.1);
  dwells[10] = Still(3.0);
  dwells[11] = Still(4.0);
  EXPECT_TRUE(FindFrozen(dwells).empty());
}

// Steps of 2 to 30 times the noise, and means that hardly move: equal readings are no wonder.
TEST(FrozenReadings, CoarseStepsAreNone) {
  for (const double step : {0.1, 1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 30.0}) {
    for (const double moves : {0.0, 0.01, 0.1, 1.0, 3.0}) {
      EXPECT_TRUE(FindFrozen(DwellsOf(step, 200, moves)).empty()) << step << " " << moves;
    }
  }
}

TEST(FrozenReadings, StepsFinerThanTheNoiseHideNoFrozenChannel) {
  std::vector<DwellReadings> dwells = DwellsOf(0.5, 100, 0.1);
  for (std::size_t i = 50; i < 60; ++i) dwells[i] = Still(102.0);
  EXPECT_EQ(FindFrozen(dwells).size(), 1U);
}

SyntheticSweep ThreePasses(std::uint64_t seed) {
  return {.stations = 13, .passes = 3, .samples = 10, .white = 20e-9, .drift = 30e-9, .seed = seed};
}

// In these rows the probe holds the first of their readings.
using Where = std::function<bool(double x_mm, double pass, double direction)>;
recording::Recording Frozen(recording::Recording recording, std::size_t probe, const Where& where) {
  const auto& columns = recording.columns;
  std::vector<double>& gap = recording.columns[kFirstGapColumn + probe].values;
  double held = 0.0;
  for (std::size_t i = 0; i < gap.size(); ++i) {
    if (!where(columns[1].values[i], columns[kPassColumn].values[i],
               columns[kDirectionColumn].values[i])) {
      continue;
    }
    if (held == 0.0) held = gap[i];
    gap[i] = held;
  }
  return recording;
}

TEST(FrozenChannel, ItsDwellsAreLeftOutAndNamed) {
  InsideU95 inside;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const SyntheticSweep sweep = ThreePasses(seed);
    const SweepSetup setup = SetupOfNoiseOnly();
    const recording::Recording sound = Record(sweep, setup);
    const SweepResult whole = ReduceSweep(
        Frozen(sound, 1, [](double, double pass, double) { return pass == 2.0; }), setup);
    const SweepResult half = ReduceSweep(
        Frozen(sound, 3, [](double, double pass, double way) { return pass == 3.0 && way < 0.0; }),
        setup);
    inside.Add(sweep, whole);
    inside.Add(sweep, half);
    EXPECT_TRUE(Tells(whole,
                      "to the last digit in 26 dwells, from pass 2 forward, X = 0 mm to "
                      "pass 2 backward, X = 0 mm"));
    EXPECT_TRUE(Tells(whole, "probe_b shows "));
    EXPECT_TRUE(Tells(half, "in 13 dwells, from pass 3 backward, X = 60 mm to pass 3 backward"));
    EXPECT_TRUE(Tells(half, "probe_d shows "));
    EXPECT_EQ(whole.dwells.size(), 52U);
    EXPECT_EQ(whole.counts.used + whole.counts.flagged + whole.counts.moving, whole.counts.rows);
    EXPECT_FALSE(Tells(ReduceSweep(sound, setup), "to the last digit"));
  }
  EXPECT_GT(inside.share(), 0.92);
}

TEST(FrozenChannel, TooLittleThatIsLeftIsRefusedWithTheChannel) {
  SyntheticSweep sweep = ThreePasses(1);
  sweep.passes = 1;
  const recording::Recording sound = Record(sweep, SetupOfNoiseOnly());
  const auto frozen =
      Frozen(sound, 4, [](double x, double, double way) { return way < 0.0 && x < 52.0; });
  try {
    ReduceSweep(frozen, SetupOfNoiseOnly());
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("a channel is frozen: probe_e shows"));
  }
}

// One direction is left: its errors, and two notes.
TEST(FrozenChannel, AWholeDirectionThatIsLeftOutIsTold) {
  SyntheticSweep sweep = ThreePasses(1);
  sweep.passes = 1;
  const auto frozen = Frozen(Record(sweep, SetupOfNoiseOnly()), 4,
                             [](double, double, double way) { return way < 0.0; });
  const SweepResult result = ReduceSweep(frozen, SetupOfNoiseOnly());
  EXPECT_TRUE(Tells(result, "probe_e shows "));
  EXPECT_TRUE(Tells(result, "forward passes only"));
}

}  // namespace frozen_readings_test
}  // namespace abbe::probes
