// A wave is found at its own number and at those that the places show alike.
#include "diagnosis/wave_spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe::diagnosis {
namespace wave_spectrum_test {

using Eigen::ArrayXd;
using Eigen::Index;

constexpr double kTurn = 2.0 * std::numbers::pi, kHighest = 60.0, kFrequency = 4.27;

WaveRows Sampled(const ArrayXd& at) {
  return {at, (kTurn * kFrequency * at + 0.7).sin(), ArrayXd::Ones(at.size())};
}

TEST(WaveSpectrum, HasThePowerOfAWaveAtItsNumber) {
  const WaveRows rows = Sampled(ArrayXd::LinSpaced(2001, 0.0, 20.0));
  const WaveGrid grid(rows.length(), kHighest);
  const ArrayXd power = grid.PowerOf(rows);
  const Index strongest = PeaksOf(power, 100.0).front();
  EXPECT_NEAR(grid.WaveAt(strongest), kFrequency, grid.step());
  // (sum of sines squared)^2 over as much: half of the rows, less what lies beside the grid.
  EXPECT_NEAR(power[strongest], 1000.5, 0.2 * 1000.5);
  EXPECT_LT(power.tail(power.size() / 2).maxCoeff(), 10.0);
}

// Ten readings a second show 4.27 Hz like 5.73, 14.27, 15.73 and so on.
TEST(WaveSpectrum, HasAPeakAtEveryAlias) {
  const double pace = 10.0;
  const WaveRows rows = Sampled(ArrayXd::LinSpaced(251, 0.0, 25.0));
  const WaveGrid grid(rows.length(), kHighest);
  const std::vector<Index> peaks = PeaksOf(grid.PowerOf(rows), 50.0);
  for (double whole = 0.0; whole < kHighest; whole += pace) {
    for (const double alias : {whole + kFrequency, whole + pace - kFrequency}) {
      const auto is_near = [&](Index peak) {
        return std::abs(grid.WaveAt(peak) - alias) < grid.step();
      };
      EXPECT_TRUE(std::ranges::any_of(peaks, is_near)) << alias;
    }
  }
}

TEST(WaveSpectrum, HasNoPeakThatIsTooLow) {
  ArrayXd power(5);
  power << 1.0, 3.0, 2.0, 7.0, 6.0;
  const std::vector<Index> expected{3, 1};
  EXPECT_EQ(PeaksOf(power, 2.0), expected);
  EXPECT_TRUE(PeaksOf(power, 7.0).empty());
}

}  // namespace wave_spectrum_test
}  // namespace abbe::diagnosis
