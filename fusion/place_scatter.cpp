#include "fusion/place_scatter.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "fusion/machine_problem.h"
#include "fusion/population_evidence.h"
#include "fusion/reversals.h"
#include "simulation/disturbance.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kEncoders = 6;          // that may be rivals; a run without them shows nothing
constexpr double kLeast = 1e-8;       // m: the search for sd begins here, and goes on in steps of
constexpr double kFactor = 1.09;      // so large a factor
constexpr int kTried = 110;           // up to 0.1 mm
constexpr Index kFewPlaces = 20;      // too few to tell
constexpr double kAlike = 1e-4;       // m: positions
constexpr double kFarOffPose = 25.0;  // of the median square
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

// What disturbances show in the rows of each pose: the squares of its singular values, and of the
// rows along its left singular vectors; disturbances x poses.
struct Directions {
  Eigen::ArrayXXd sizes, along;
};

// `r`: rows of a pose x poses; `shown`: the same for each disturbance.
Directions DirectionsOf(const MatrixXd& r, const std::vector<MatrixXd>& shown) {
  const Index count = std::min<Index>(r.rows(), std::ssize(shown));
  Directions directions{Eigen::ArrayXXd(count, r.cols()), Eigen::ArrayXXd(count, r.cols())};
  MatrixXd G(r.rows(), std::ssize(shown));
  for (Index pose = 0; pose < r.cols(); ++pose) {
    for (Index column = 0; column < G.cols(); ++column) G.col(column) = shown[column].col(pose);
    const Eigen::JacobiSVD<MatrixXd> svd(G, Eigen::ComputeThinU);
    directions.sizes.col(pose) = svd.singularValues().cwiseAbs2();
    directions.along.col(pose) = (svd.matrixU().transpose() * r.col(pose)).cwiseAbs2();
  }
  return directions;
}

// `n`, `rr`: how many rows, and the sum of their squares.
Found Search(double n, double rr, const Directions& directions) {
  Found best;
  double rho = kLeast;
  for (int step = 0; step < kTried; ++step, rho *= kFactor) {
    const Eigen::ArrayXXd more = rho * rho * directions.sizes;
    const double square = rr - (directions.along * more / (1.0 + more)).sum();
    const double gain = -0.5 * n * std::log(square / rr) - 0.5 * (1.0 + more).log().sum();
    if (gain > best.gain) best = {gain, std::sqrt(square / n), rho * std::sqrt(square / n)};
  }
  return best;
}

// Poses without those that are far off all others: an outlier is no wave.
std::vector<Index> UsualPoses(const MatrixXd& r) {
  const VectorXd squares = r.colwise().squaredNorm();
  std::vector<double> sorted(squares.begin(), squares.end());
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::vector<Index> usual;
  for (Index pose = 0; pose < r.cols(); ++pose) {
    if (squares[pose] <= kFarOffPose * *middle) usual.push_back(pose);
  }
  return usual;
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

// What the positioning errors of the map hold of evident waves at places (3 x n).
simulation::Disturbance WavesHeld(const machine::VolumetricModel& found, const MachinePrior& prior,
                                  const std::array<bool, machine::kAxes>& evident,
                                  const MatrixXd& places) {
  simulation::Disturbance held(places.cols());
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    if (!evident[axis]) continue;
    machine::ErrorFunction wave = found.Function(axis, axis);
    wave.SetCoefficients(prior.PartOfWave(axis) * wave.coefficients());
    for (Index i = 0; i < places.cols(); ++i) {
      held.row(simulation::MotionStage(axis, axis))[i] = wave.Evaluate(places(axis, i));
    }
  }
  return held;
}

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
  if (logs.empty()) return alone;
  const double most = *std::max_element(logs.begin(), logs.end());
  double weights = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const double weight = std::exp(logs[i] - most);
    weights += weight;
    sum += weight * squares[i];
  }
  return std::sqrt(sum / weights);
}

// The variance of a positioning error whose coefficients have variance 1, rms over the travel.
double SquaresOf(const machine::VolumetricModel& found, int axis) {
  constexpr Index kStations = 101;
  const auto& function = found.Function(axis, axis);
  const auto& travel = found.travels()[axis];
  VectorXd gradient(function.size());
  double squares = 0.0;
  for (const double x : VectorXd::LinSpaced(kStations, travel.first, travel.last)) {
    function.Evaluate(x, nullptr, gradient.data());
    squares += gradient.squaredNorm() / kStations;
  }
  return squares;
}

}  // namespace

std::array<bool, machine::kAxes> ThatMayShowWaves(
    const std::vector<simulation::SimulatedRun>& runs) {
  std::array<bool, machine::kAxes> axes{};
  for (const simulation::SimulatedRun& run : runs) {
    if (!run.response) continue;
    for (int axis = 0; axis < machine::kAxes; ++axis) {
      std::set<long> positions;
      for (const double x : run.commanded.row(axis)) positions.insert(std::lround(x / kAlike));
      axes[axis] = axes[axis] || std::ssize(positions) >= kFewPlaces;
    }
  }
  return axes;
}

PlaceScatter FindPlaceScatter(const simulation::SimulatedRun& run, const VectorXd& left,
                              const machine::VolumetricModel& found, const MachinePrior& prior,
                              const std::array<bool, machine::kAxes>& evident) {
  const Index poses = run.commanded.cols();
  if (!run.response || poses < kFewPlaces || left.size() % poses != 0) return {};
  const Index rows = left.size() / poses;
  if (rows < 2) return {};
  std::vector<estimation::ParameterBlock> blocks = run.blocks;
  std::erase_if(blocks, IsReversal);  // of which the response knows nothing
  const auto response = run.response->At(NominalValues(blocks));
  if (!response->RowsAreIndependent()) return {};
  const VectorXd waves =
      left + response->Columns({WavesHeld(found, prior, evident, run.commanded)});
  const std::vector<Index> usual = UsualPoses(waves.reshaped(rows, poses));
  const auto of_usual = [&](const VectorXd& column) {
    return MatrixXd(column.reshaped(rows, poses)(Eigen::all, usual));
  };
  const MatrixXd r = of_usual(waves);
  const auto shown = [&](Index stage) {
    simulation::Disturbance everywhere(poses);
    everywhere.row(stage).setOnes();
    return of_usual(response->Columns({everywhere}));
  };
  const auto search = [&](const std::vector<MatrixXd>& stages) {
    return Search(static_cast<double>(r.size()), r.squaredNorm(), DirectionsOf(r, stages));
  };
  std::vector<MatrixXd> axes, encoders;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    axes.push_back(shown(simulation::MotionStage(axis, axis)));
  }
  for (int encoder = 0; encoder < kEncoders; ++encoder) {
    encoders.push_back(shown(simulation::kEncoderStage + encoder));
  }
  PlaceScatter named;
  Found best{.gain = kEvident};
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const Found one = search({axes[static_cast<std::size_t>(axis)]});
    if (!(one.gain > best.gain)) continue;
    best = one;
    named.axis = axis;
  }
  if (named.axis < 0) return {};
  std::vector<std::vector<MatrixXd>> rivals{axes, encoders};
  for (const MatrixXd& encoder : encoders) rivals.push_back({encoder});
  for (const auto& rival : rivals) {
    if (search(rival).gain > best.gain) return {};
  }
  const MatrixXd& g = axes[static_cast<std::size_t>(named.axis)];
  const VectorXd gg = g.colwise().squaredNorm();
  const VectorXd x = run.commanded(named.axis, usual),
                 e = g.cwiseProduct(of_usual(left)).colwise().sum();
  named.sd = SizeOfWave({x, e.cwiseQuotient(gg), best.noise * gg.cwiseSqrt().cwiseInverse()},
                        best.sd, named.axis, found, prior);
  if (evident[named.axis]) named.held = prior.population().wave[named.axis];
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
    // The error counts from that at the reference, which is displaced likewise: twice the variance.
    const double variance = 2.0 * largest * largest / SquaresOf(found, axis);
    machine::VolumetricModel only = found;
    only.SetParameters(VectorXd::Zero(found.ParameterCount()));
    only.SetCoefficients(axis, axis,
                         VectorXd::Constant(found.Function(axis, axis).size(), variance));
    seen.covariance.diagonal() += only.Parameters();
    double& u = seen.functions[axis * machine::kMotions + axis].u;
    u = std::hypot(u, std::numbers::sqrt2 * largest);
  }
}

}  // namespace abbe::fusion
