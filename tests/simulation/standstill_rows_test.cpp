// The rows of a long standstill, and what their means share of a noise with a memory: the sum over
// all pairs of readings.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "simulation/sweep/sweep_run.h"

namespace abbe::simulation {
namespace standstill_rows_test {

using Eigen::Index;

constexpr double kStep = 0.1;  // s
constexpr std::size_t kReadings = 2000;

double GapAt(std::size_t row) { return 100.0 + 0.01 * static_cast<double>(row % 37); }  // um

recording::Recording Standstill() {
  recording::Recording dwell;
  dwell.name = "dwell";
  dwell.header = "kind = \"dwell\"\naxis = \"X\"\n";
  const auto add = [&](const std::string& name, auto value) {
    dwell.columns.push_back({name, {}});
    for (std::size_t row = 0; row < kReadings; ++row) {
      dwell.columns.back().values.push_back(value(row));
    }
  };
  add("time_s", [](std::size_t row) { return kStep * static_cast<double>(row); });
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) add(axis, [](std::size_t) { return 5.0; });
  for (const char probe : {'a', 'b', 'c', 'd', 'e'}) add(fmt::format("probe_{}_um", probe), GapAt);
  return dwell;
}

TEST(StandstillRows, AreSingleReadingsThenMeansOfAllTheOthers) {
  const SweepRun run =
      ReadStillReadings(Standstill(), {.probe = 1e-8, .drift = 0.0, .drift_time = 1.0});
  ASSERT_GT(run.rows(), static_cast<Index>(kStillReadings));
  EXPECT_LE(run.rows(), static_cast<Index>(kStillReadings + kLaterBlocks));
  EXPECT_EQ(run.samples.head(kStillReadings).maxCoeff(), 1.0);
  EXPECT_EQ(run.samples.sum(), static_cast<double>(kReadings));
  std::size_t reading = 0;
  for (Index row = 0; row < run.rows(); ++row) {
    double sum = 0.0;
    const auto count = static_cast<std::size_t>(run.samples[row]);
    for (std::size_t i = 0; i < count; ++i) sum += GapAt(reading++);
    EXPECT_NEAR(run.gap(2, row), 1e-6 * sum / static_cast<double>(count), 1e-15) << row;
    EXPECT_NEAR(run.covariance[2](row, row), 1e-16 / static_cast<double>(count), 1e-22) << row;
  }
}

TEST(StandstillRows, ShareANoiseWithAMemoryAsTheirReadingsDo) {
  // An integral for a sum: (step / memory)^2 / 12 off in each of two means.
  constexpr double kMemory = 0.7, kSlow = 30e-9, kOfSteps = 4e-3;
  probes::ProbeNoise noise{.probe = 1e-12, .drift = 0.0, .drift_time = 1.0};
  noise.memory[2] = kSlow;
  noise.memory_time[2] = kMemory;
  const SweepRun run = ReadStillReadings(Standstill(), noise);
  const auto first = [&](Index row) { return run.samples.head(row).sum(); };
  for (const Index a : {Index{3}, Index{125}, Index{126}, Index{180}}) {
    for (const Index b : {Index{4}, Index{119}, Index{125}, Index{127}}) {
      double sum = 0.0;
      for (double i = first(a); i < first(a) + run.samples[a]; ++i) {
        for (double j = first(b); j < first(b) + run.samples[b]; ++j) {
          sum += std::exp(-kStep * std::abs(i - j) / kMemory);
        }
      }
      const double shared = kSlow * kSlow * sum / (run.samples[a] * run.samples[b]);
      EXPECT_NEAR(run.covariance[2](a, b), shared, kOfSteps * shared + 1e-23) << a << ", " << b;
    }
  }
}

}  // namespace standstill_rows_test
}  // namespace abbe::simulation
