#include "learned/confounding.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/linear_runs.h"
#include "diagnosis/shortlist.h"
#include "simulation/stage_channel.h"
#include "simulation/variables.h"

namespace abbe::learned {
namespace {

using diagnosis::Candidate;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Likeness {
  std::string name;
  double cosine;
};

// A constant and, but for a straight line itself, a straight line in each variable.
std::vector<std::string> LinesBeside(const simulation::LearnedTerm& term) {
  const bool is_line = std::ranges::all_of(term.expression.terms, [](const auto& product) {
    return product.size() == 1 && product.front().form == simulation::Atom::Form::kLinear;
  });
  return is_line ? std::vector<std::string>{} : term.expression.Variables();
}

simulation::Cause LinesOf(const simulation::LearnedTerm& term) {
  const auto variables = LinesBeside(term);
  simulation::Cause lines;
  lines.id = "lines";
  lines.plausible = VectorXd::Ones(static_cast<Index>(variables.size()) + 1);
  lines.columns = [variables, channel = simulation::ChannelNamed(term.object).value()](
                      const simulation::Trace& trace, const simulation::Object&,
                      const VectorXd&) -> std::vector<simulation::Disturbance> {
    if (!channel.Feels(trace)) return {};
    std::vector<simulation::Disturbance> columns{
        simulation::InStage(trace, channel.stage, Eigen::RowVectorXd::Ones(trace.rows()))};
    for (const std::string& variable : variables) {
      const Eigen::RowVectorXd values = simulation::ValuesInUnit(variable, trace);
      if (values.size() == 0) return {};
      columns.push_back(simulation::InStage(trace, channel.stage, values));
    }
    return columns;
  };
  return lines;
}

// The share of the term's effect, as a cosine, in what a cause spans.
double CosineOf(const MatrixXd& of_cause, const VectorXd& with_term, double of_term) {
  constexpr double kAbsorbed = 1e-8;
  if (!(of_term > 0.0) || of_cause.size() == 0) return 0.0;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(of_cause);
  double share = 0.0;
  for (Index i = 0; i < with_term.size(); ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > kAbsorbed * eigen.eigenvalues().maxCoeff())) continue;
    share += std::pow(eigen.eigenvectors().col(i).dot(with_term), 2) / value;
  }
  return std::sqrt(std::min(1.0, share / of_term));
}

}  // namespace

std::vector<Candidate> NamedBeside(const diagnosis::Fit& base,
                                   const std::vector<Candidate>& found) {
  const auto all = diagnosis::CandidatesOf(base.campaign());
  std::vector<Candidate> named;
  for (const diagnosis::Named& each : diagnosis::Shortlist(base, all)) {
    const Candidate& candidate = each.best.candidate;
    if (!candidate.cause->IsRandomField() && !diagnosis::IsAmong(found, candidate)) {
      named.push_back(candidate);
    }
  }
  return named;
}

double ImitatedByRows(const diagnosis::Fit& fit, const simulation::LearnedTerm& term,
                      double chi_square) {
  const auto channel = simulation::ChannelNamed(term.object).value();
  const auto variables = LinesBeside(term);
  const auto count = static_cast<Index>(variables.size()) + 1;
  MatrixXd A_A = MatrixXd::Zero(count, count);
  VectorXd A_e = VectorXd::Zero(count);
  double whole = 0.0;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const simulation::Trace& trace = fit.TraceOf(run);
    if (trace.rows() == 0 || !channel.Feels(trace)) continue;
    const MatrixXd functions = term.expression.Of(trace);
    const Eigen::RowVectorXd weights = fit.ScoresOf(run, channel.stage).weights;
    if (functions.rows() == 0 || weights.size() == 0) continue;
    const Eigen::RowVectorXd effect = term.coefficients.transpose() * functions;
    MatrixXd A = MatrixXd::Ones(count, trace.rows());
    for (Index i = 1; i < count; ++i) {
      A.row(i) = simulation::ValuesInUnit(variables[static_cast<std::size_t>(i - 1)], trace);
    }
    whole += weights.dot(effect.cwiseAbs2());
    A_A += A * weights.asDiagonal() * A.transpose();
    A_e += A * weights.cwiseProduct(effect).transpose();
  }
  whole -= A_e.dot(A_A.completeOrthogonalDecomposition().solve(A_e));
  return whole > 0.0 ? 1.0 - std::sqrt(std::min(1.0, chi_square / whole)) : 1.0;
}

Confounding ConfoundingOf(const diagnosis::Fit& fit, const Candidate& term,
                          const simulation::LearnedTerm& what, const diagnosis::Fit& base,
                          const std::vector<Candidate>& named) {
  const diagnosis::Campaign& campaign = base.campaign();
  const simulation::Cause lines = LinesOf(what);
  std::vector<Candidate> candidates{term, {&lines, term.object, {}}};
  candidates.insert(candidates.end(), named.begin(), named.end());
  const diagnosis::LinearRuns linear(campaign, campaign.runs(), diagnosis::ValuesOf(base.result()));
  std::vector<diagnosis::RunSums> sums;
  for (std::size_t run = 0; run < linear.count(); ++run) {
    sums.push_back(linear.SumsOf(linear.At(run), candidates));
  }
  const MatrixXd S = linear.Information(diagnosis::PointersTo(sums));
  const Index own = term.cause->coefficients();
  VectorXd along = VectorXd::Ones(own);
  for (std::size_t i = 0; i < fit.taken_in().size(); ++i) {
    if (fit.taken_in()[i].Name() == term.Name()) along = fit.ScoreOf(i).coefficients;
  }
  const double of_term = along.dot(S.topLeftCorner(own, own) * along);
  const Index of_lines = lines.coefficients(), both = own + of_lines;
  MatrixXd C_C = MatrixXd::Zero(both, both);
  for (const auto& each : sums) C_C += each.C_C.topLeftCorner(both, both);
  const double all = along.dot(C_C.topLeftCorner(own, own) * along);
  const double share_of_lines = CosineOf(C_C.bottomRightCorner(of_lines, of_lines),
                                         C_C.bottomLeftCorner(of_lines, own) * along, all);
  const double whole = all * (1.0 - share_of_lines * share_of_lines);
  Confounding confounding;
  constexpr double kRounding = 1e-9;
  confounding.imitated =
      whole > kRounding * all ? 1.0 - std::sqrt(std::min(1.0, of_term / whole)) : 1.0;
  std::vector<Likeness> alike;
  Index first = both;
  for (std::size_t i = 2; i < candidates.size(); ++i) {
    const Index count = candidates[i].cause->coefficients();
    const VectorXd with_term = S.block(first, 0, count, own) * along;
    alike.push_back(
        {candidates[i].Name(), CosineOf(S.block(first, first, count, count), with_term, of_term)});
    first += count;
  }
  std::ranges::stable_sort(alike, std::greater(), &Likeness::cosine);
  if (!alike.empty() && alike.front().cosine > 0.0) {
    confounding.nearest = alike.front().name;
    confounding.cosine = alike.front().cosine;
  }
  for (const Likeness& each : alike) {
    if (each.cosine > kAlike) confounding.group.push_back(each.name);
  }
  return confounding;
}

}  // namespace abbe::learned
