#include "fusion/place_scatter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "fusion/map_doubt.h"
#include "fusion/reversals.h"
#include "simulation/disturbance.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kEncoders = 6;      // at most, that may be a rival
constexpr double kNamed = 10.0;   // of the logarithm, over noise alone
constexpr double kLeast = 1e-8;   // m: the search for sd begins here, and goes on in steps of
constexpr double kFactor = 1.09;  // so large a factor
constexpr int kTried = 110;       // up to 0.1 mm
constexpr Index kFewPlaces = 20;  // too few to tell
constexpr Index kMostPlaces = 250;
// m: correlation lengths l of a wave, the longest as a part of that of the error; sizes t, and
// their prior.
constexpr double kShortestWave = 0.5e-3, kLongestWave = 0.2, kLengthFactor = 1.41;
constexpr double kLeastWave = 2e-8, kMostWave = 3e-5, kSizeFactor = 1.8;
constexpr double kUsual = 1e-6;
const double kUsualTo = std::log(4.0);
constexpr std::array kParts{0.0, 0.35, 0.7, 1.0};  // of what scatters without a place

struct Found {
  double gain = 0.0, noise = 0.0, sd = 0.0;  // of the logarithm; c; rho c, m
};

// `r`, `g`: rows of a pose x poses.
Found Search(const MatrixXd& r, const MatrixXd& g) {
  const Eigen::ArrayXd gg = g.colwise().squaredNorm().transpose();
  const Eigen::ArrayXd gr = g.cwiseProduct(r).colwise().sum().transpose();
  const auto n = static_cast<double>(r.size());
  const double rr = r.squaredNorm();
  Found best;
  double rho = kLeast;
  for (int step = 0; step < kTried; ++step, rho *= kFactor) {
    const Eigen::ArrayXd times = 1.0 + rho * rho * gg;
    const double square = rr - rho * rho * (gr.square() / times).sum();
    const double gain = -0.5 * n * std::log(square / rr) - 0.5 * times.log().sum();
    if (gain > best.gain) best = {gain, std::sqrt(square / n), rho * std::sqrt(square / n)};
  }
  return best;
}

// The error of an axis at places: positions, errors and their noise, m.
struct Places {
  VectorXd x, e, noise;

  Places(const VectorXd& at, const VectorXd& error, const VectorXd& sd) {
    const Index every = (at.size() + kMostPlaces - 1) / kMostPlaces;
    const auto some = Eigen::seq(0, at.size() - 1, every);
    x = at(some);
    e = error(some);
    noise = sd(some);
  }
};

// The root of the mean of s^2 + t^2; `alone`: m, s where there is no wave.
double SizeOfWave(const Places& at, double alone, int axis, const machine::VolumetricModel& found,
                  const MachinePrior& prior) {
  const auto& function = found.Function(axis, axis);
  MatrixXd S(at.x.size(), function.size());
  VectorXd gradient(function.size()), e = at.e;  // as measured
  for (Index i = 0; i < at.x.size(); ++i) {
    e[i] += function.Evaluate(at.x[i], nullptr, gradient.data());
    S.row(i) = gradient.transpose();
  }
  const auto spread = prior.SpreadOf(axis, axis);
  const MatrixXd root = S * spread.axes * spread.deviations.asDiagonal();
  const double unit = at.noise.mean();  // of lengths here
  MatrixXd smooth = root * root.transpose() / (unit * unit);
  smooth.diagonal() += (at.noise / unit).cwiseAbs2();
  const double longest = kLongestWave * prior.population().length(axis, axis);
  std::vector<double> logs, squares;
  for (double length = kShortestWave; length < longest; length *= kLengthFactor) {
    MatrixXd wave(at.x.size(), at.x.size());
    for (Index j = 0; j < wave.cols(); ++j) {
      wave.col(j) = (-0.5 * ((at.x.array() - at.x[j]) / length).square()).exp();
    }
    for (const double part : kParts) {
      const double square = std::pow(part * alone, 2);
      MatrixXd rest = smooth;
      rest.diagonal().array() += square / (unit * unit);
      for (double sd = kLeastWave; sd < kMostWave; sd *= kSizeFactor) {
        const MatrixXd all = rest + std::pow(sd / unit, 2) * wave;
        const Eigen::LLT<MatrixXd> factor(all);
        logs.push_back(-0.5 * factor.matrixL().solve(e / unit).squaredNorm() -
                       factor.matrixLLT().diagonal().array().log().sum() -
                       0.5 * std::pow(std::log(sd / kUsual) / kUsualTo, 2));
        squares.push_back(sd * sd + square);
      }
    }
  }
  if (logs.empty()) return 0.0;
  const double most = *std::max_element(logs.begin(), logs.end());
  double weights = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double weight = std::exp(logs[i] - most);
    weights += weight;
    sum += weight * squares[i];
  }
  return std::sqrt(sum / weights);
}

VectorXd NominalOf(const simulation::SimulatedRun& run) {
  std::vector<double> values;
  for (const auto& block : run.blocks) {
    if (IsReversal(block)) continue;
    for (const auto& entry : block.entries) values.push_back(entry.value);
  }
  return Eigen::Map<const VectorXd>(values.data(), std::ssize(values));
}

}  // namespace

PlaceScatter FindPlaceScatter(const simulation::SimulatedRun& run, const VectorXd& left,
                              const machine::VolumetricModel& found, const MachinePrior& prior) {
  if (!run.response) return {};
  const auto response = run.response->At(NominalOf(run));
  const Index poses = response->WeightsOf(0).size();
  if (!response->RowsAreIndependent() || run.commanded.cols() != poses || poses < kFewPlaces ||
      left.size() % poses != 0 || left.size() < 2 * poses) {
    return {};
  }
  const Index rows = left.size() / poses;
  const MatrixXd r = left.reshaped(rows, poses);
  const auto shown = [&](Index stage, Index of_poses) {
    simulation::Disturbance there(poses);
    there.row(stage).head(of_poses).setOnes();
    return VectorXd(response->Columns({there}).col(0));
  };
  const auto search = [&](Index stage) {
    const bool one_after_the_other = shown(stage, 1).tail(left.size() - rows).isZero(0.0);
    if (!one_after_the_other) return Found();
    return Search(r, shown(stage, poses).reshaped(rows, poses));
  };
  PlaceScatter named;
  Found best{.gain = kNamed};
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const Found one = search(simulation::MotionStage(axis, axis));
    if (!(one.gain > best.gain)) continue;
    best = one;
    named.axis = axis;
  }
  if (named.axis < 0) return {};
  for (int encoder = 0; encoder < kEncoders; ++encoder) {
    if (search(simulation::kEncoderStage + encoder).gain > best.gain) return {};
  }
  const MatrixXd g =
      shown(simulation::MotionStage(named.axis, named.axis), poses).reshaped(rows, poses);
  const VectorXd gg = g.colwise().squaredNorm();
  const VectorXd x = run.commanded.row(named.axis), e = g.cwiseProduct(r).colwise().sum();
  named.sd = SizeOfWave({x, e.cwiseQuotient(gg), best.noise * gg.cwiseSqrt().cwiseInverse()},
                        best.sd, named.axis, found, prior);
  return named;
}

void CountScatter(const std::vector<PlaceScatter>& scatter, const machine::VolumetricModel& found,
                  SeenErrors& seen) {
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    double largest = 0.0;
    for (const PlaceScatter& each : scatter) {
      if (each.axis == axis) largest = std::max(largest, each.sd);
    }
    if (largest == 0.0) continue;
    AddScatter(axis, largest, found, seen.covariance);
    double& u = seen.functions[axis * machine::kMotions + axis].u;
    u = std::hypot(u, std::numbers::sqrt2 * largest);
  }
}

}  // namespace abbe::fusion
