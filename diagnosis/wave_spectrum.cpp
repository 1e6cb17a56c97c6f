#include "diagnosis/wave_spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace abbe::diagnosis {

using Eigen::ArrayXd;
using Eigen::Index;

WaveGrid::WaveGrid(double length, double highest)
    : points_(64), waves_(0), step_(0.5 / length), spacing_(0.0) {
  constexpr double kPointsPerWave = 4.0;  // the shortest
  while (points_ < kPointsPerWave * highest / step_) points_ *= 2;
  spacing_ = 1.0 / (step_ * points_);
  waves_ = static_cast<Index>(highest / step_) + 1;
}

ArrayXd WaveGrid::PowerOf(const WaveRows& piece) const {
  std::vector<double> on_grid(points_, 0.0);
  const double first = piece.at.minCoeff();
  for (Index row = 0; row < piece.at.size(); ++row) {
    const auto point = std::lround((piece.at[row] - first) / spacing_);
    on_grid[point % points_] += piece.scores[row];
  }
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> spectrum;
  transform.fwd(spectrum, on_grid);
  const double information = 0.5 * piece.weights.sum();
  ArrayXd power(waves_);
  for (Index wave = 0; wave < waves_; ++wave) {
    power[wave] = std::norm(spectrum[wave]) / information;
  }
  return power;
}

std::vector<Index> PeaksOf(const ArrayXd& power, double least) {
  std::vector<Index> peaks;
  const Index last = power.size() - 1;
  for (Index i = 0; i <= last; ++i) {
    const bool above =
        (i == 0 || power[i] >= power[i - 1]) && (i == last || power[i] > power[i + 1]);
    if (above && power[i] > least) peaks.push_back(i);
  }
  std::sort(peaks.begin(), peaks.end(), [&](Index a, Index b) { return power[a] > power[b]; });
  return peaks;
}

}  // namespace abbe::diagnosis
