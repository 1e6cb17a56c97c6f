#include "simulation/shaft/shaft_noise.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

namespace abbe::simulation {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kTellingOrders = 4;  // of the sense
constexpr double kByChance = 2.0;  // standard deviations of a correlation of white noise

std::vector<Index> RowsOf(const ShaftRun& run, int sensor) {
  std::vector<Index> rows;
  for (std::size_t row = 0; row < run.rim.sensor.size(); ++row) {
    if (run.rim.sensor[row] == sensor) rows.push_back(row);
  }
  return rows;
}

// sin and cos of each order, then the offsets of the turns.
MatrixXd DesignOf(const ShaftRun& run, const std::vector<Index>& rows) {
  const int turns = *std::max_element(run.turn.begin(), run.turn.end());
  MatrixXd design = MatrixXd::Zero(rows.size(), 2 * kRepeatedOrders + turns);
  for (Index i = 0; i < design.rows(); ++i) {
    const Index row = rows[i];
    for (Index n = 1; n <= kRepeatedOrders; ++n) {
      design(i, 2 * n - 2) = std::sin(n * run.rim.shaft[row]);
      design(i, 2 * n - 1) = std::cos(n * run.rim.shaft[row]);
    }
    design(i, 2 * kRepeatedOrders + run.turn[row] - 1) = 1.0;
  }
  return design;
}

// 1 + 2 sum of the correlations.
double Inflation(const VectorXd& left) {
  const double chance = kByChance / std::sqrt(left.size());
  double inflation = 1.0;
  for (Index apart = 1; apart < left.size() / 4; ++apart) {
    const Index pairs = left.size() - apart;
    const double correlation = left.head(pairs).dot(left.tail(pairs)) / left.squaredNorm();
    if (correlation < chance) break;
    inflation += 2.0 * correlation;
  }
  return inflation;
}

// gap = Re(wave exp(i n shaft)) at n = 1 ...
std::vector<Complex> WavesOf(const VectorXd& found) {
  std::vector<Complex> waves;
  for (Index n = 1; n <= kTellingOrders; ++n) {
    waves.emplace_back(found[2 * n - 1], -found[2 * n - 2]);
  }
  return waves;
}

// How much of the waves a rim that goes by in this sense could be.
double Coherence(const std::vector<std::vector<Complex>>& waves, const std::vector<double>& places,
                 int sense) {
  double power = 0.0;
  for (int n = 1; n <= kTellingOrders; ++n) {
    Complex sum = 0.0;
    for (std::size_t s = 0; s < waves.size(); ++s) {
      sum += waves[s][n - 1] * std::polar(1.0, n * sense * places[s]);
    }
    power += std::norm(sum);
  }
  return power;
}

}  // namespace

RimRepeats RepeatsOf(const ShaftRun& run) {
  RimRepeats repeats;
  repeats.turns = std::numeric_limits<double>::infinity();
  repeats.freedom = std::numeric_limits<Index>::max();
  repeats.scatter.resize(run.rim.sensors);
  repeats.sd.resize(run.rim.sensors);
  std::vector<std::vector<Complex>> waves;
  std::vector<double> places;
  for (int sensor = 0; sensor < run.rim.sensors; ++sensor) {
    const std::vector<Index> rows = RowsOf(run, sensor);
    const Eigen::RowVectorXd shaft = run.rim.shaft(rows);
    repeats.turns =
        std::min(repeats.turns, (shaft.maxCoeff() - shaft.minCoeff()) / (2.0 * std::numbers::pi));
    const VectorXd gap = run.rim.gap(rows).transpose();
    const MatrixXd design = DesignOf(run, rows);
    const Eigen::CompleteOrthogonalDecomposition<MatrixXd> fit(design);
    const VectorXd found = fit.solve(gap);
    waves.push_back(WavesOf(found));
    places.push_back(run.rim.place[rows.front()]);
    const VectorXd left = gap - design * found;
    const Index freedom = gap.size() - fit.rank();
    repeats.freedom = std::min(repeats.freedom, freedom);
    const double variance = left.squaredNorm() / (freedom - 2);
    repeats.scatter[sensor] = std::sqrt(variance);
    repeats.sd[sensor] = std::sqrt(variance * Inflation(left));
  }
  repeats.sense = Coherence(waves, places, -1) > Coherence(waves, places, 1) ? -1 : 1;
  constexpr Index kLeastTurnFreedom = 12;
  if (repeats.turns < kLeastTurns || repeats.freedom < kLeastTurnFreedom) {
    repeats.scatter.resize(0);
    repeats.sd.resize(0);
  }
  return repeats;
}

}  // namespace abbe::simulation
