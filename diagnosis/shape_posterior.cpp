#include "diagnosis/shape_posterior.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "diagnosis/evidence.h"
#include "standards/coverage.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kKnown = 0.1;  // standard deviation of a logarithm that first order will do for
constexpr int kShapesTried = 201;
constexpr double kAnySize = 1e3;    // times what is plausible
constexpr double kNoWeight = 1e-3;  // of a shape: left out

// The posterior of the logarithm of the shape, to first order.
double DeviationOf(const Score& score) {
  return std::sqrt(score.covariance(score.covariance.rows() - 1, score.covariance.cols() - 1));
}

// All that are plausible, evenly in the logarithm.
std::vector<Candidate> AllShapes(const Score& score, const simulation::Scene& scene) {
  const auto plausible = score.candidate.cause->shapes(scene);
  const double first = std::log(plausible.front()[0]), last = std::log(plausible.back()[0]);
  std::vector<Candidate> candidates(kShapesTried, score.candidate);
  for (Candidate& candidate : candidates) candidate.coarseness *= kAnySize;
  for (int i = 0; i < kShapesTried; ++i) {
    candidates[i].shape[0] = std::exp(first + (last - first) * i / (kShapesTried - 1));
  }
  return candidates;
}

// With the coefficients that fit best: the evidence without what it costs that they may vary.
double LogLikelihood(const Score& score) {
  const VectorXd precision = score.candidate.Plausible().cwiseInverse();
  const MatrixXd scaled = precision.asDiagonal() * score.covariance * precision.asDiagonal();
  return score.log_evidence - 0.5 * std::log(scaled.determinant());
}

// Below which 95 % of the weights lie.
double Quantile(const VectorXd& values, const VectorXd& weights) {
  std::vector<Index> order(values.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return values[a] < values[b]; });
  double below = 0.0;
  for (const Index i : order) {
    below += weights[i];
    if (below >= 0.95) return values[i];
  }
  return values[order.back()];
}

}  // namespace

bool IsHardlyKnown(const Score& score) {
  return score.candidate.HasFreeShape() && score.candidate.shape.size() == 1 &&
         DeviationOf(score) > kKnown;
}

ShapePosterior::ShapePosterior(const Fit& without, Score score)
    : without_(without),
      score_(std::move(score)),
      all_(ScoreAll(without, AllShapes(score_, without.campaign().scene()))),
      weights_(all_.size()) {
  for (Index i = 0; i < weights_.size(); ++i) weights_[i] = LogLikelihood(all_[i]);
  weights_ = (weights_.array() - weights_.maxCoeff()).exp().eval();
  weights_ /= weights_.sum();
}

Score ShapePosterior::Widened() const {
  const Index count = score_.coefficients.size(), shapes = weights_.size();
  MatrixXd off(count + 1, shapes), around(count + 1, shapes);  // of each shape, and its variances
  for (Index i = 0; i < shapes; ++i) {
    const Score& each = all_[i];
    // As a share of what was found, as a report states it: of a time constant three times as long
    // that is 2, its logarithm 1.1.
    off.col(i) << each.coefficients - score_.coefficients,
        each.candidate.shape[0] / score_.candidate.shape[0] - 1.0;
    around.col(i) << each.covariance.diagonal(), 0.0;
  }
  MatrixXd moment = off * weights_.asDiagonal() * off.transpose();
  moment.diagonal() += around * weights_;
  const VectorXd deviation = moment.diagonal().cwiseSqrt();
  VectorXd stretch(count + 1);
  for (Index d = 0; d <= count; ++d) {
    const VectorXd reach = (off.row(d).array().square() +
                            standards::kCoverage * standards::kCoverage * around.row(d).array())
                               .sqrt();
    stretch[d] = Quantile(reach, weights_) / (standards::kCoverage * deviation[d]);
  }
  Score widened = score_;
  widened.covariance = stretch.asDiagonal() * moment * stretch.asDiagonal();
  return widened;
}

std::vector<MatrixXd> ShapePosterior::Added() const {
  std::vector<Candidate> shapes{score_.candidate};
  std::vector<VectorXd> coefficients{score_.coefficients};
  std::vector<double> weights{0.0};
  for (Index i = 0; i < weights_.size(); ++i) {
    if (weights_[i] < kNoWeight) continue;
    shapes.push_back(all_[i].candidate);
    coefficients.push_back(all_[i].coefficients);
    weights.push_back(weights_[i]);
  }
  const auto [disturber, groups] = TogetherOf(shapes);
  std::vector<MatrixXd> added;
  for (const MatrixXd& by_each : without_.MovedBy(disturber, groups)) {
    const Index rows = by_each.rows(), count = score_.coefficients.size();
    const auto moved = [&](std::size_t shape) -> VectorXd {
      return by_each.middleCols(static_cast<Index>(shape) * count, count) * coefficients[shape];
    };
    added.push_back(MatrixXd::Zero(rows, rows));
    for (std::size_t shape = 1; rows > 0 && shape < shapes.size(); ++shape) {
      const VectorXd off = moved(shape) - moved(0);
      added.back() += weights[shape] * off * off.transpose();
    }
  }
  return added;
}

}  // namespace abbe::diagnosis
