#include "diagnosis/scatter.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/measured_noise.h"
#include "simulation/excess_noise.h"
#include "standards/chi_squared.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kLags = 10;
constexpr Index kFewRows = 8 * kLags;  // with less there are no such correlations
// The unknowns of a sweep, one for six rows, leave correlations of their own: in 250 worlds without
// an effect the least chance was 1e-4.
constexpr double kDoubtOfMemory = 1e-6;

// What was whitened by a memory is held against what is stated, of as many rows as are independent.
// An arm of few poses has nearly as many unknowns as rows, and its rows scatter less for it.
Leftover ScatterOf(const VectorXd& left, const PreparedRun& run, double freedom) {
  const double square = left.squaredNorm() / freedom * run.excess * run.excess;
  if (run.memory) {
    const VectorXd& time = run.trace.time;
    freedom *= run.memory->Independent((time.maxCoeff() - time.minCoeff()) / (time.size() - 1));
  }
  const double beyond = std::sqrt(std::max(0.0, square - 1.0));
  const double p_value = standards::ChiSquaredExceeds(
      square * freedom / (simulation::kNoiseIsKnown * simulation::kNoiseIsKnown), freedom);
  return {kScatter, {}, beyond, {"times the noise"}, p_value, 0.0};
}

// Channels x instants.
MatrixXd InTime(const VectorXd& left, const simulation::Trace& trace) {
  const Index instants = trace.rows(), channels = left.size() / instants;
  if (trace.head) return left.reshaped(instants, channels).transpose();
  return left.reshaped(channels, instants);
}

Leftover MemoryOf(const MatrixXd& left) {
  const Index n = left.cols();
  const double rows = n;
  double sum = 0.0, most = 0.0, all = 0.0;
  for (Index k = 1; k <= kLags; ++k) {
    for (Index channel = 0; channel < left.rows(); ++channel) {
      const double a = left.row(channel).head(n - k).dot(left.row(channel).tail(n - k)) /
                       left.row(channel).squaredNorm();
      sum += rows * (rows + 2.0) * a * a / (n - k);
      most = std::max(most, a);
      all += a;
    }
  }
  // A drift that is stated and not there leaves rows that alternate.
  const double p_value = all > 0.0 ? standards::ChiSquaredExceeds(sum, kLags * left.rows()) : 1.0;
  return {kMemory, {}, std::sqrt(most), {"times the noise"}, p_value, 0.0};
}

// A run that scatters less than is stated is whitened with too much noise, and what is left of its
// drift goes on.
bool HasNeighbours(const PreparedRun& run, const VectorXd& left) {
  const double rows = left.size();
  return run.trace.continuous && run.trace.rows() >= kFewRows &&
         left.size() % run.trace.rows() == 0 &&
         left.squaredNorm() * simulation::kNoiseIsKnown * simulation::kNoiseIsKnown > rows;
}

// How often the variance of so many readings is larger than the largest that is no fault.
Leftover AtRest(const simulation::NoisyChannel& noisy) {
  const double beyond = std::pow(noisy.factor / kFarMore, 2);
  return {kAtRest,
          noisy.name,
          noisy.factor,
          {"times the noise"},
          standards::ChiSquaredExceeds(noisy.freedom * beyond, noisy.freedom),
          0.0};
}

}  // namespace

std::vector<Leftover> RunsThatScatter(const Fit& fit) {
  std::vector<Leftover> found;
  for (const auto& noisy : fit.campaign().instruments().noisy) found.push_back(AtRest(noisy));
  const auto& runs = fit.campaign().runs();
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const VectorXd& left = fit.LeftOf(run);
    if (left.size() == 0) continue;
    const double freedom = runs[run].EstimatesNoise()
                               ? std::max(1.0, fit.result().sources[run].redundancy)
                               : static_cast<double>(left.size());
    std::vector<Leftover> answers{ScatterOf(left, runs[run], freedom)};
    if (HasNeighbours(runs[run], left)) answers.push_back(MemoryOf(InTime(left, runs[run].trace)));
    for (Leftover& answer : answers) {
      answer.object = runs[run].simulated.name;
      answer.p_value *= 2 * runs.size();
      const double doubt = answer.variable == kMemory ? kDoubtOfMemory : kDoubt;
      if (answer.p_value < doubt) found.push_back(std::move(answer));
    }
  }
  return found;
}

}  // namespace abbe::diagnosis
