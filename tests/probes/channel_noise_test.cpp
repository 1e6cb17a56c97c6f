// The noise and the mains of a channel against what was put in.
#include "probes/channel_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "random/counter_random.h"

namespace abbe::probes::channel_noise_test {
namespace {

struct Series {
  std::vector<double> times, values;
};

// 200 readings at 200 Hz of white noise 0.02 and a sine.
Series Readings(std::uint64_t seed, double amplitude, double hertz) {
  const random::CounterRandom random(seed, 1);
  Series series;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const double time = 7.0 + 0.005 * static_cast<double>(i);
    series.times.push_back(time);
    series.values.push_back(100.0 + 0.02 * random.Normal(i) +
                            amplitude * std::sin(2.0 * std::numbers::pi * hertz * time + 0.7));
  }
  return series;
}

TEST(ChannelNoise, MeanNoiseAndMains) {
  for (const double hertz : {50.0, 60.0}) {
    const Series series = Readings(1, 0.1, hertz);
    const ChannelNoise found = NoiseOf(series.times, series.values);
    EXPECT_EQ(found.readings, 200u);
    EXPECT_NEAR(found.mean, 100.0, 4.0 * 0.02 / std::sqrt(200.0));
    EXPECT_NEAR(found.noise, 0.02, 4.0 * 0.02 / std::sqrt(400.0));
    EXPECT_NEAR(found.mains, 0.1, 4.0 * 0.02 * std::sqrt(2.0 / 200.0));
    EXPECT_EQ(found.mains_hz, hertz);
  }
}

TEST(ChannelNoise, WhiteNoiseIsTakenForMainsInTwoOfAThousand) {
  int taken = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const Series series = Readings(seed, 0.0, 50.0);
    taken += NoiseOf(series.times, series.values).mains > 0.0 ? 1 : 0;
  }
  // Two frequencies at 0.1 % each: 4 of 2000, standard deviation 2.
  EXPECT_LE(taken, 4 + 8);
  EXPECT_GE(taken, 1);
}

TEST(ChannelNoise, ConstantAndMissingReadings) {
  const std::vector<double> times = {0.0, 1.0, 2.0};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(NoiseOf(times, std::vector{3.0, 3.0, 3.0}).constant);
  const ChannelNoise one = NoiseOf(times, std::vector{nan, 3.0, nan});
  EXPECT_EQ(one.readings, 1u);
  EXPECT_EQ(one.mean, 3.0);
  EXPECT_TRUE(std::isnan(NoiseOf(times, std::vector{nan, nan, nan}).mean));
}

}  // namespace
}  // namespace abbe::probes::channel_noise_test
