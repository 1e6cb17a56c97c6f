#include "diagnosis/expected_odds.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index FirstOf(const std::vector<RivalWorld>& rivals, std::size_t rival) {
  Index first = 0;
  for (std::size_t i = 0; i < rival; ++i) first += rivals[i].candidate.cause->coefficients();
  return first;
}

// The evidence of one rival, and its derivatives by its score.
struct Expected {
  double evidence;
  VectorXd by_score;
};

// `m`: the mean of the score.
Expected ExpectedOf(const Candidate& candidate, const MatrixXd& S, const VectorXd& m) {
  if (candidate.cause->IsBinary()) return {m[0] - 0.5 * S(0, 0), VectorXd::Ones(1)};
  // In units of what is plausible.
  const VectorXd plausible = candidate.Plausible();
  const auto& unit = plausible.asDiagonal();
  const MatrixXd scaled = unit * S * unit;
  const VectorXd mean = unit * m;
  const MatrixXd grown = scaled + MatrixXd::Identity(S.rows(), S.cols());
  const Eigen::LLT<MatrixXd> M(grown);
  const double log_determinant = 2.0 * MatrixXd(M.matrixL()).diagonal().array().log().sum();
  const VectorXd solved = M.solve(mean);
  return {0.5 * (mean.dot(solved) + M.solve(scaled).trace() - log_determinant), unit * solved};
}

// The evidence of all rivals, and its derivatives by all scores, one column each.
struct Outlook {
  VectorXd evidence;
  MatrixXd by_score;
};

Outlook OutlookOf(const MatrixXd& S, const std::vector<RivalWorld>& rivals, std::size_t truth) {
  const Index first_true = FirstOf(rivals, truth);
  const VectorXd& a = rivals[truth].coefficients;
  const Index worlds = rivals.size();
  Outlook outlook{VectorXd(worlds), MatrixXd::Zero(S.rows(), worlds)};
  for (Index x = 0; x < worlds; ++x) {
    const Candidate& candidate = rivals[x].candidate;
    const Index first = FirstOf(rivals, x), count = candidate.cause->coefficients();
    const Expected expected = ExpectedOf(candidate, S.block(first, first, count, count),
                                         S.block(first, first_true, count, a.size()) * a);
    outlook.evidence[x] = expected.evidence;
    outlook.by_score.col(x).segment(first, count) = expected.by_score;
  }
  return outlook;
}

// The mean of 1 / sum of exp(logs), logs normal with these deviations and one common deviate.
double MeanProbability(const VectorXd& logs, const VectorXd& deviations) {
  constexpr double kFar = 6.0, kStep = 0.05;  // standard deviations
  double sum = 0.0, weights = 0.0;
  for (double deviate = -kFar; deviate <= kFar; deviate += kStep) {
    const double weight = std::exp(-0.5 * deviate * deviate);
    sum += weight / (logs + deviate * deviations).array().exp().sum();
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

VectorXd ExpectedEvidence(const MatrixXd& S, const std::vector<RivalWorld>& rivals,
                          std::size_t truth) {
  return OutlookOf(S, rivals, truth).evidence;
}

double ExpectedProbability(const MatrixXd& before, const MatrixXd& after,
                           const std::vector<RivalWorld>& rivals) {
  VectorXd now(rivals.size());
  for (std::size_t i = 0; i < rivals.size(); ++i) {
    now[i] = rivals[i].probability;
  }
  now /= now.sum();
  double expected = 0.0;
  for (std::size_t truth = 0; truth < rivals.size(); ++truth) {
    const Outlook then = OutlookOf(after, rivals, truth);
    const VectorXd logs =
        now.array().log().matrix() + then.evidence - ExpectedEvidence(before, rivals, truth);
    const MatrixXd apart = then.by_score.colwise() - then.by_score.col(truth).eval();
    const MatrixXd scatter = apart.transpose() * (after - before) * apart;
    expected += now[truth] * MeanProbability(logs.array() - logs[truth],
                                             scatter.diagonal().cwiseMax(0.0).cwiseSqrt());
  }
  return expected;
}

MatrixXd FreeOfOthers(const MatrixXd& S, Index count, const VectorXd& plausible) {
  const Index others = S.rows() - count;
  if (others == 0) return S;
  const auto& unit = plausible.asDiagonal();
  MatrixXd grown = unit * S.bottomRightCorner(others, others) * unit;
  grown.diagonal().array() += 1.0;
  const MatrixXd cross = unit * S.bottomLeftCorner(others, count);
  const Eigen::LLT<MatrixXd> factor(grown);
  return S.topLeftCorner(count, count) - cross.transpose() * factor.solve(cross);
}

}  // namespace abbe::diagnosis
