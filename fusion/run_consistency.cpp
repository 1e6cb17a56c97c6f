#include "fusion/run_consistency.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "estimation/in_parallel.h"
#include "fusion/marginal.h"
#include "standards/chi_squared.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSeen = 0.5;           // lambda
constexpr double kSignificance = 0.01;  // of the whole set
constexpr double kRounding = 1e-12;
constexpr double kLeastShare = 1e-12;  // least share of the others in a parameter's information

// What an iteration left to do. A run that knows a direction a million times better than all others
// would call a thousandth of its standard deviation there one of theirs.
VectorXd StepToSolution(const MatrixXd& all, const VectorXd& gradient) {
  const VectorXd scale =
      all.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
  MatrixXd scaled = scale.asDiagonal() * all * scale.asDiagonal();
  scaled.diagonal().array() += kRounding;
  const VectorXd right = -scale.cwiseProduct(gradient);
  const Eigen::LLT<MatrixXd> factor(scaled);
  if (factor.info() != Eigen::Success) return VectorXd::Zero(gradient.size());
  const VectorXd step = factor.solve(right);
  return scale.cwiseProduct(step);
}

// `left`: the step to the solution from where the problem was linearised.
RunConsistency Check(const std::string& name, const estimation::SourceSums& run,
                     const MatrixXd& rest, const VectorXd& left) {
  std::vector<int> others, own;
  for (int i = 0; i < rest.rows(); ++i) {
    (rest(i, i) > kLeastShare * run.information(i, i) ? others : own).push_back(i);
  }
  const VectorXd score = run.gradient + run.information * left;
  const Score seen = WithoutNuisance({run.information, score}, others, own);
  RunConsistency check{.name = name};
  std::vector<int> touched;
  for (int i = 0; i < std::ssize(others); ++i) {
    if (run.information.diagonal()[others[i]] > 0.0) touched.push_back(i);
  }
  const MatrixXd factor = MarginalFactor(rest(others, others), touched);
  if (factor.size() == 0) return check;
  // Parameters that the run does not depend on are marginalised; L = U'^-1 with H = U U'.
  const auto U = factor.triangularView<Eigen::Lower>();
  const MatrixXd half = U.solve(MatrixXd(seen.information(touched, touched)));
  const MatrixXd M = U.solve(MatrixXd(half.transpose()));
  const MatrixXd symmetric = 0.5 * (M + M.transpose());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(symmetric);
  const VectorXd y = eigen.eigenvectors().transpose() * U.solve(VectorXd(seen.score(touched)));
  for (Index i = 0; i < y.size(); ++i) {
    const double lambda = eigen.eigenvalues()[i];
    if (!(lambda > kSeen)) continue;
    check.statistic += (1.0 + lambda) / lambda * y[i] * y[i];
    ++check.directions;
  }
  if (check.directions > 0) {
    check.probability = standards::ChiSquaredExceeds(check.statistic, check.directions);
  }
  return check;
}

// Sources that are runs.
std::vector<std::size_t> RunsOf(const estimation::Problem& problem) {
  std::vector<std::size_t> runs;
  for (std::size_t s = 0; s < problem.sources().size(); ++s) {
    if (!problem.sources()[s].options.is_prior) runs.push_back(s);
  }
  return runs;
}

// The information of all but these sources; a difference to all of them would be rounded.
MatrixXd Without(const std::set<std::size_t>& excluded, const estimation::Linearization& sums) {
  MatrixXd rest = sums.prior.information;
  for (std::size_t s = 0; s < sums.sources.size(); ++s) {
    if (!excluded.contains(s)) rest += sums.sources[s].information;
  }
  return rest;
}

// At the solution of all but the excluded ones.
std::vector<RunConsistency> CheckAllBut(const std::set<std::size_t>& excluded,
                                        const estimation::Problem& problem,
                                        const estimation::Linearization& sums) {
  VectorXd gradient = sums.Gradient();
  for (const std::size_t s : excluded) gradient -= sums.sources[s].gradient;
  const VectorXd left = StepToSolution(Without(excluded, sums), gradient);
  std::vector<std::size_t> runs = RunsOf(problem);
  std::erase_if(runs, [&](std::size_t run) { return excluded.contains(run); });
  std::vector<RunConsistency> checks(runs.size());
  estimation::InParallel(runs.size(), [&](std::size_t r) {
    std::set<std::size_t> others = excluded;
    others.insert(runs[r]);
    checks[r] =
        Check(problem.sources()[runs[r]].name, sums.sources[runs[r]], Without(others, sums), left);
  });
  return checks;
}

}  // namespace

std::vector<RunConsistency> CheckRuns(const estimation::Problem& problem,
                                      const estimation::Linearization& sums) {
  return CheckAllBut({}, problem, sums);
}

std::vector<int> MayBeWrong(const estimation::Problem& problem,
                            const estimation::Linearization& sums) {
  const std::vector<std::size_t> runs = RunsOf(problem);
  std::vector<int> may_be;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (Contradicting(CheckAllBut({runs[r]}, problem, sums)) < 0) {
      may_be.push_back(static_cast<int>(r));
    }
  }
  return may_be;
}

namespace {

// The logarithm of a probability of chi-square that underflows: the first term of its expansion.
double FarOut(const RunConsistency& run) {
  const double half = 0.5 * run.statistic, a = 0.5 * run.directions;
  return (a - 1.0) * std::log(half) - half - std::lgamma(a);
}

}  // namespace

int Contradicting(const std::vector<RunConsistency>& runs) {
  const auto worst = std::min_element(runs.begin(), runs.end(), [](const auto& a, const auto& b) {
    if (a.probability == 0.0 && b.probability == 0.0) return FarOut(a) < FarOut(b);
    return a.probability < b.probability;
  });
  if (worst == runs.end()) return -1;
  if (worst->probability * runs.size() > kSignificance) return -1;
  return static_cast<int>(worst - runs.begin());
}

double BirgeRatio(const RunConsistency& run) {
  return std::sqrt(std::max(1.0, run.statistic / static_cast<double>(run.directions)));
}

double CorrelationIn(const Eigen::VectorXd& left) {
  constexpr Eigen::Index kFewRows = 50;  // too few to tell
  double largest = 0.0;
  for (const Eigen::Index lag : {1, 3}) {
    const Eigen::Index n = left.size() - lag;
    if (n < kFewRows) continue;
    largest = std::max(largest, left.head(n).dot(left.tail(n)) / left.squaredNorm());
  }
  return largest;
}

}  // namespace abbe::fusion
