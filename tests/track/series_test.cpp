// A made response with known gains and lags is found again; what no temperature does is refused.
#include "track/series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::track {
namespace series_test {

using Eigen::Index;

constexpr Index kRows = 240;
constexpr double kStep = 30.0;  // s
constexpr double kGain = -3.0, kLag = 400.0, kNoise = 0.5;

// A warm-up, and the response in small steps of Euler.
Series Made(std::uint64_t seed = 3, double lag = kLag, Index rows = kRows) {
  const random::CounterRandom random(seed, 1);
  Series series{
      .name = "made",
      .time = Eigen::VectorXd::LinSpaced(rows, 0.0, kStep * static_cast<double>(rows - 1)),
      .value = Eigen::VectorXd(rows),
      .sensors = {"frame"},
      .temperature = Eigen::MatrixXd(1, rows)};
  const auto room = [](double t) {
    return 20.0 + 10.0 * (1.0 - std::exp(-t / 1500.0)) + std::sin(t / 300.0);
  };
  double lagged = room(0.0);
  for (Index row = 0; row < rows; ++row) {
    const double t = series.time[row];
    series.temperature(0, row) = room(t);
    series.value[row] = kGain * lagged + kNoise * random.Normal(static_cast<std::uint64_t>(row));
    constexpr int kSub = 3000;
    for (int i = 0; i < kSub; ++i)
      lagged += kStep / kSub / lag * (room(t + kStep * i / kSub) - lagged);
  }
  return series;
}

TEST(Series, FindsGainLagAndNoise) {
  const SeriesResponse response = LearnResponse(Made(), {});
  ASSERT_EQ(response.sensors.size(), 1U);
  const SeriesSensor& frame = response.sensors.front();
  EXPECT_NEAR(frame.gain, kGain, 4.0 * frame.u_gain);
  EXPECT_LT(frame.u_gain, 0.2);
  EXPECT_NEAR(frame.lag / kLag, 1.0, 0.1);
  EXPECT_NEAR(response.noise / kNoise, 1.0, 4.0 / std::sqrt(2.0 * kRows));
}

// Few rows hardly tell the lag, and the gain with it.
TEST(Series, ItsUncertaintiesHoldWhereTheLagIsHardlySeen) {
  constexpr int kSeeds = 60;
  int gains = 0, lags = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const random::CounterRandom draw(seed, 2);
    const double lag = 150.0 * std::exp(2.0 * draw.Uniform(0));
    const SeriesSensor frame = LearnResponse(Made(seed, lag, 60), {}).sensors.front();
    if (std::abs(frame.gain - kGain) < 2.0 * frame.u_gain) ++gains;
    if (lag > frame.shortest && lag < frame.longest) ++lags;
  }
  EXPECT_GE(gains, 53);  // 57 of 60, less two and a half standard deviations
  EXPECT_GE(lags, 53);
}

TEST(Series, ALagThatIsNotSeenSaysSo) {
  Series still = Made();
  still.temperature.setConstant(20.0);
  still.temperature.rightCols(1).array() += 1e-6;
  EXPECT_FALSE(LearnResponse(still, {}).sensors.front().longest <
               3.0 * LearnResponse(still, {}).sensors.front().shortest);
  EXPECT_TRUE(LearnResponse(Made(), {}).sensors.front().lag_seen);
}

TEST(Series, PredictsWhatIsHeldOut) {
  const Series series = Made();
  std::vector<bool> held_out(kRows);
  for (Index row = 0; row < kRows; ++row) held_out[row] = row / 20 % 2 == 1;
  Series spoiled = series;  // what is held out is not looked at
  for (Index row = 0; row < kRows; ++row) {
    if (held_out[row]) spoiled.value[row] += 3.0;
  }
  const SeriesResponse response = LearnResponse(spoiled, held_out);
  double inside = 0.0, count = 0.0;
  for (Index row = 0; row < kRows; ++row) {
    if (!held_out[row]) continue;
    count += 1.0;
    if (std::abs(response.value[row] - series.value[row]) < 2.0 * response.u[row]) inside += 1.0;
  }
  EXPECT_GT(inside / count, 0.88);  // 0.95 less four standard deviations of 120 rows
}

TEST(Series, RefusesJumpsAndClocksThatGoBack) {
  Series jumps = Made();
  jumps.value.tail(100).array() += 500.0;
  try {
    LearnResponse(jumps, {});
    FAIL() << "a jump was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("row 141: jumps by"), std::string::npos)
        << error.what();
  }
  Series back = Made();
  back.time[50] -= 100.0;
  EXPECT_THROW(LearnResponse(back, {}), InputError);
  Series few = Made();
  few.time.conservativeResize(5);
  few.value.conservativeResize(5);
  few.temperature.conservativeResize(1, 5);
  EXPECT_THROW(LearnResponse(few, {}), InputError);
}

}  // namespace series_test
}  // namespace abbe::track
