#include "estimation/reading_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "random/counter_random.h"

namespace abbe::estimation {
namespace {

double Rounded(double value, double step) { return std::round(value / step) * step; }

ReadingStep Readings(double step, double noise, double written, int count = 400) {
  const random::CounterRandom draw(3, 1);
  ReadingStep readings;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
    const double value =
        40.0 + 10.0 * std::sin(0.01 * static_cast<double>(i)) + noise * draw.Normal(i);
    readings.Add(Rounded(step > 0.0 ? Rounded(value, step) : value, written));
  }
  return readings;
}

TEST(ReadingStep, IsThatOfAConverter) {
  EXPECT_NEAR(Readings(0.05, 0.01, 1e-6).Step(), 0.05, 1e-9);
  EXPECT_NEAR(Readings(200.0 / 4096, 0.3, 1e-6).Step(), 200.0 / 4096, 1e-8);
  EXPECT_NEAR(Readings(200.0 / 4096, 0.3, 1e-4).Step(), 200.0 / 4096, 1e-5);
  EXPECT_LT(Readings(0.0, 0.02, 1e-6, 3000).Step(), 2e-6);  // as it is written
  EXPECT_EQ(Readings(0.0, 0.02, 1e-14).Step(), 0.0);
  ReadingStep few;
  for (const double one : {1.0, 2.0, 4.0, 2.0}) few.Add(one);
  EXPECT_EQ(few.Step(), 0.0);
}

// The mean of many rounded readings at a place anywhere in a step, by their own scatter.
TEST(ReadingStep, LeavesWhatNoRepetitionShows) {
  constexpr double kStep = 1.0;
  constexpr std::uint64_t kReadings = 20'000, kPlaces = 41;
  for (const double noise : {0.02, 0.1, 0.2, 0.3, 0.4, 0.6}) {
    const random::CounterRandom draw(5, static_cast<std::uint64_t>(1000 * noise));
    double off = 0.0, unseen = 0.0;
    for (std::uint64_t place = 0; place < kPlaces; ++place) {
      const double truth = static_cast<double>(place) / kPlaces;
      double sum = 0.0, squares = 0.0;
      for (std::uint64_t i = 0; i < kReadings; ++i) {
        const double read = Rounded(truth + noise * draw.Normal(place * kReadings + i), kStep);
        sum += read / kReadings;
        squares += read * read / kReadings;
      }
      off += std::pow(sum - truth, 2) / kPlaces;
      unseen += (squares - sum * sum) / kPlaces;
    }
    const double u = ReadingStep::Unseen(kStep, unseen);
    EXPECT_GT(u, 0.4 * off - 2e-5) << noise;  // the noise of the means
    EXPECT_LT(u, 2.5 * off + 2e-4) << noise;
  }
  EXPECT_NEAR(ReadingStep::Unseen(2.0, 0.0), 4.0 / 12.0, 1e-15);
  EXPECT_EQ(ReadingStep::Unseen(0.0, 1.0), 0.0);
}

}  // namespace
}  // namespace abbe::estimation
