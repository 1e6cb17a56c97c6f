// Scores made of a known wave or of a known interval, at uneven places.
#include "diagnosis/scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "random/counter_random.h"

namespace abbe::diagnosis {
namespace scan_test {

using Eigen::Index;
using Eigen::RowVectorXd;

constexpr Index kRows = 3000;
constexpr double kFirst = 20.0, kLast = 70.0;

// Crowded at the beginning; each row knows as much as another.
Scan Places() {
  RowVectorXd values(kRows);
  for (Index i = 0; i < kRows; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(kRows - 1);
    values[i] = kFirst + (kLast - kFirst) * part * part;
  }
  return {values, Eigen::MatrixXd::Zero(2, kRows), Eigen::MatrixXd::Ones(2, kRows)};
}

TEST(Scan, FindsTheWaveOfEachChannel) {
  const double step = 0.4 * 2.0 * std::numbers::pi / (kLast - kFirst);
  Scan scan = Places();
  scan.scores.row(0) = (120.0 * step * scan.values.array()).sin();
  scan.scores.row(1) = (33.0 * step * scan.values.array() + 1.0).cos();
  const auto waves = StrongestWaves(scan, step);
  EXPECT_NEAR(waves[0], 120.0 * step, 1e-9);
  EXPECT_NEAR(waves[1], 33.0 * step, 1e-9);
}

TEST(Scan, FindsTheIntervalOfEachChannelToACell) {
  const double cell = (kLast - kFirst) / static_cast<double>(kLines);
  Scan scan = Places();
  const random::CounterRandom noise(7, 1);
  for (Index i = 0; i < kRows; ++i) {
    const auto at = static_cast<std::uint64_t>(i);
    const double value = scan.values[i];
    scan.scores(0, i) = 0.1 * noise.Normal(2 * at) - (value > 31.0 && value < 33.5 ? 1.0 : 0.0);
    scan.scores(1, i) = 0.1 * noise.Normal(2 * at + 1) + (value > 64.0 ? 1.0 : 0.0);
  }
  const auto intervals = StrongestIntervals(scan);
  EXPECT_NEAR(intervals[0].from, 31.0, cell);
  EXPECT_NEAR(intervals[0].to, 33.5, cell);
  EXPECT_NEAR(intervals[1].from, 64.0, cell);
  EXPECT_GT(intervals[1].to, kLast) << "with the last row";
}

TEST(Scan, FindsNothingWhereNothingIs) {
  const Scan scan = Places();
  EXPECT_EQ(StrongestWaves(scan, 0.1)[0], 0.0);
  EXPECT_TRUE(StrongestIntervals(scan)[0].IsEmpty());
}

TEST(Scan, FindsNothingAtOnePlace) {
  Scan scan = Places();
  scan.values.setConstant(kFirst);
  scan.scores.setOnes();
  EXPECT_TRUE(StrongestIntervals(scan)[0].IsEmpty());
}

}  // namespace scan_test
}  // namespace abbe::diagnosis
