// Recordings of a turning shaft: what is read, what is refused, how well turns repeat.
#include "simulation/shaft/shaft_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "simulation/shaft/shaft_noise.h"

namespace abbe::simulation {
namespace shaft_run_test {

using recording::Recording;
using testing::HasSubstr;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoise = 2e-6;  // m

struct Turning {
  std::string header = "sensor_deg = [0, 90]\n";
  double turns = 4.0;
  double sense = 1.0;
};

// Twenty readings a cell of the sensors 1 and 2, between angles a degree apart; 0.1 mm once per
// turn, white noise.
Recording Shaft(const Turning& turning = {}) {
  const random::CounterRandom random(5, 1);
  Recording recording;
  recording.name = "turning.csv";
  recording.header = "kind = \"shaft\"\n" + turning.header;
  recording.columns = {{"time_s", {}}, {"shaft_deg", {}}, {"gap_1_mm", {}}, {"gap_2_mm", {}}};
  std::uint64_t next = 0;
  const auto row = [&](double time, double shaft, double first, double second) {
    const std::array<double, 4> values{time, shaft, first, second};
    for (std::size_t c = 0; c < values.size(); ++c) {
      recording.columns[c].values.push_back(values[c]);
    }
  };
  for (double degrees = 0.0; degrees <= 360.0 * turning.turns; degrees += 1.0) {
    row(0.01 * degrees, std::fmod(degrees, 360.0), kNone, kNone);
    const double shaft = (degrees + 0.5) * std::numbers::pi / 180.0;
    const auto gap = [&](double place) {
      return 1.0 + 0.1 * std::cos(shaft - turning.sense * place) +
             1e3 * kNoise * random.Normal(next++);
    };
    row(0.01 * (degrees + 0.5), kNone, gap(0.0), gap(0.5 * std::numbers::pi));
  }
  return recording;
}

void ExpectRefused(const Recording& recording, const std::string& words) {
  try {
    ReadShaftRun(recording);
    ADD_FAILURE() << "was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("turning.csv"));
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(ShaftRun, PutsEachReadingAtItsAngle) {
  const ShaftRun run = ReadShaftRun(Shaft());
  EXPECT_EQ(run.rim.sensors, 2);
  EXPECT_EQ(run.sense, 0);
  EXPECT_NEAR(static_cast<double>(run.rows()), 2 * 4 * 180, 2);
  for (Eigen::Index row = 0; row < run.rows(); ++row) {
    const double place = run.rim.sensor[static_cast<std::size_t>(row)] * 0.5 * std::numbers::pi;
    EXPECT_DOUBLE_EQ(run.rim.place[row], place);
    EXPECT_NEAR(run.rim.gap[row], 1e-3 + 1e-4 * std::cos(run.rim.shaft[row] - place), 5.0 * kNoise);
  }
}

TEST(ShaftRun, TellsTheSenseAndTheNoise) {
  for (const double sense : {1.0, -1.0}) {
    ShaftRun run = ReadShaftRun(Shaft({.sense = sense}));
    const RimRepeats repeats = RepeatsOf(run);
    EXPECT_EQ(repeats.sense, sense);
    EXPECT_NEAR(repeats.turns, 4.0, 0.02);
    ASSERT_EQ(repeats.sd.size(), 2);
    for (int sensor = 0; sensor < 2; ++sensor) {
      // Two readings a row; 4 standard deviations of a deviation from so many degrees of freedom.
      const double expected = kNoise / std::numbers::sqrt2;
      const double kScatter = 4.0 / std::sqrt(2.0 * static_cast<double>(repeats.freedom));
      EXPECT_NEAR(repeats.scatter[sensor] / expected, 1.0, kScatter);
      // White: no more than chance correlates.
      EXPECT_LT(repeats.sd[sensor] / repeats.scatter[sensor], 1.15);
    }
    SetSense(repeats.sense, run);
    EXPECT_DOUBLE_EQ(run.rim.place.tail<1>()[0], sense * 0.5 * std::numbers::pi);
    SetSense(repeats.sense, run);  // as it is
    EXPECT_DOUBLE_EQ(run.rim.place.tail<1>()[0], sense * 0.5 * std::numbers::pi);
  }
}

TEST(ShaftRun, CannotTellNoiseFromLessThanTwoTurns) {
  EXPECT_EQ(RepeatsOf(ReadShaftRun(Shaft({.turns = 1.5}))).sd.size(), 0);
}

TEST(ShaftRun, BelievesItsHeader) {
  const ShaftRun run =
      ReadShaftRun(Shaft({.header = "sensor_deg = [10, 100]\nshaft_sense = -1\nu_gap_um = 3\n"}));
  EXPECT_EQ(run.sense, -1);
  EXPECT_DOUBLE_EQ(run.rim.place[0], -10.0 * std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(run.sd[1], 3e-6);
}

TEST(ShaftRun, RefusesWhatItCannotRead) {
  ExpectRefused(Shaft({.header = ""}), "sensor_deg = [0, 120, 240]");
  ExpectRefused(Shaft({.header = "sensor_deg = [0, 120, 240]\n"}), "write 2 numbers");
  ExpectRefused(Shaft({.turns = 0.7}), "of a turn under gap_1_mm");
  ExpectRefused(Shaft({.header = "sensor_deg = [0, 90]\nshaft_sense = 2\n"}), "must be 1");
  ExpectRefused(Shaft({.header = "sensor_deg = [0, 90]\nu_gap_um = 0\n"}), "above 0");
  Recording other = Shaft();
  other.columns[2].name = "radial_1_mm";
  ExpectRefused(other, "gap_1_mm");
  other = Shaft();
  other.columns[1].name = "angle_deg";
  ExpectRefused(other, "shaft_deg or shaft_rad");
}

}  // namespace shaft_run_test
}  // namespace abbe::simulation
