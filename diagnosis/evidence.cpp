#include "diagnosis/evidence.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "estimation/in_parallel.h"

namespace abbe::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Disturbance;

namespace {

constexpr SizeRange kDraws{0.01e-6, 10e-6, 1.1};  // m
constexpr Index kColumnsAtOnce = 512;             // so many share the derivatives of the simulation

// One that relaxes parameters, or candidates with columns together.
std::vector<Score> ScoreTogether(const Fit& fit, std::span<const Candidate> candidates) {
  if (const Candidate& first = candidates.front(); first.cause->relaxes) {
    return {ScoreFrom(first, fit.ProjectParameters(first))};
  }
  const auto [disturber, groups] = TogetherOf(candidates);
  const std::vector<Fit::Projection> projections = fit.Project(disturber, groups);
  std::vector<Score> scores;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    scores.push_back(ScoreFrom(candidates[i], projections[i]));
  }
  return scores;
}

}  // namespace

Together TogetherOf(std::span<const Candidate> candidates) {
  Together together;
  together.disturber = [candidates](const simulation::Trace& trace) {
    std::vector<Disturbance> all;
    for (const Candidate& each : candidates) {
      auto own = each.cause->columns(trace, each.object, each.shape);
      if (own.empty()) {
        own.assign(each.cause->coefficients(), simulation::NoDisturbance(trace));
      }
      for (auto& column : own) all.push_back(std::move(column));
    }
    return all;
  };
  together.groups.reserve(candidates.size());
  for (const Candidate& each : candidates) {
    together.groups.push_back(each.cause->coefficients());
  }
  return together;
}

DrawnSize SizeOfDraws(const Fit::Projection& projection, const SizeRange& sizes, double stated) {
  const auto& [S, g] = projection;
  std::vector<Index> seen;
  for (Index i = 0; i < g.size(); ++i) {
    if (S(i, i) > 0.0) seen.push_back(i);
  }
  if (seen.empty()) return {sizes.smallest, 0.0};
  const MatrixXd of_seen = S(seen, seen);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(of_seen);
  constexpr double kRounding = 1e-9;  // of the largest: below, a score is rounding too
  const Eigen::ArrayXd information = solver.eigenvalues().array().max(0.0);
  const Eigen::ArrayXd score =
      (information > kRounding * information.maxCoeff())
          .select((solver.eigenvectors().transpose() * g(seen)).array(), 0.0);
  const auto evidence = [&](double sd) {
    const Eigen::ArrayXd grown = 1.0 + sd * sd * information;
    return 0.5 * (sd * sd * score.square() / grown - grown.log()).sum();
  };
  DrawnSize best{sizes.smallest, -std::numeric_limits<double>::infinity()};
  double sum = 0.0, count = 0.0;
  for (double sd = sizes.smallest; sd < sizes.largest; sd *= sizes.ratio, ++count) {
    const double log_evidence = evidence(sd);
    if (log_evidence > best.log_evidence) {
      sum *= std::exp(best.log_evidence - log_evidence);
      best = {sd, log_evidence};
    }
    sum += std::exp(log_evidence - best.log_evidence);
  }
  best.log_evidence += std::log(sum / count) - std::max(0.0, evidence(stated));
  return best;
}

Score ScoreFrom(Candidate candidate, const Fit::Projection& projection) {
  const auto& [S, g] = projection;
  if (candidate.cause->IsRandomField()) {
    const VectorXd usual = candidate.Plausible();
    const double visible = std::sqrt(std::max(0.0, S.diagonal().dot(usual.cwiseAbs2())));
    const DrawnSize size = SizeOfDraws(projection, kDraws, candidate.shape[1]);
    candidate.shape[0] = size.sd;
    return {std::move(candidate), VectorXd::Zero(g.size()), MatrixXd::Zero(g.size(), g.size()),
            size.log_evidence, visible};
  }
  const VectorXd plausible = candidate.Plausible();
  if (candidate.cause->IsBinary()) {
    return {candidate, VectorXd::Ones(1), MatrixXd::Zero(1, 1), g[0] - 0.5 * S(0, 0),
            std::sqrt(std::max(0.0, S(0, 0)))};
  }
  // In units of what is plausible.
  const MatrixXd scaled = plausible.asDiagonal() * S * plausible.asDiagonal();
  const MatrixXd precision = scaled + MatrixXd::Identity(S.rows(), S.cols());
  const Eigen::LLT<MatrixXd> factor(precision);
  const VectorXd mean = factor.solve(VectorXd(plausible.asDiagonal() * g));
  Score score{candidate, plausible.cwiseProduct(mean), {}, 0.0, 0.0};
  score.covariance = plausible.asDiagonal() * factor.solve(MatrixXd::Identity(S.rows(), S.cols())) *
                     plausible.asDiagonal();
  const double log_determinant = 2.0 * MatrixXd(factor.matrixL()).diagonal().array().log().sum();
  score.log_evidence = 0.5 * (mean.dot(plausible.cwiseProduct(g)) - log_determinant);
  score.visible = std::sqrt(std::max(0.0, scaled.diagonal().maxCoeff()));
  return score;
}

std::vector<Score> ScoreAll(const Fit& fit, const std::vector<Candidate>& candidates) {
  std::vector<std::span<const Candidate>> parts;
  for (auto rest = std::span(candidates); !rest.empty();) {
    std::size_t count = 1;
    Index columns = rest.front().cause->coefficients();
    for (; !rest.front().cause->relaxes && count < rest.size(); ++count) {
      if (rest[count].cause->relaxes || columns >= kColumnsAtOnce) break;
      columns += rest[count].cause->coefficients();
    }
    parts.push_back(rest.first(count));
    rest = rest.subspan(count);
  }
  std::vector<std::vector<Score>> of_parts(parts.size());
  estimation::InParallel(parts.size(),
                         [&](std::size_t i) { of_parts[i] = ScoreTogether(fit, parts[i]); });
  std::vector<Score> scores;
  scores.reserve(candidates.size());
  for (auto& part : of_parts) std::move(part.begin(), part.end(), std::back_inserter(scores));
  return scores;
}

}  // namespace abbe::diagnosis
