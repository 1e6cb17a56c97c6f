#include "diagnosis/linear_runs.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "fusion/machine_problem.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Problem;

Problem ProblemAt(const Campaign& campaign, const std::vector<PreparedRun>& runs,
                  const Values& at) {
  std::vector<simulation::SimulatedRun> simulated;
  simulated.reserve(runs.size());
  for (const PreparedRun& run : runs) simulated.push_back(run.simulated);
  Problem problem = fusion::MakeMachineProblem(campaign.instruments().machine, campaign.model(),
                                               campaign.prior(), simulated);
  for (const auto& [name, values] : at) {
    const auto known = [&, block = name](const auto& other) { return other.name == block; };
    if (std::none_of(problem.blocks().begin(), problem.blocks().end(), known)) continue;
    auto& entries = problem.Block(problem.Find(name)).entries;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      entries[i].value = values[i];
    }
  }
  return problem;
}

void AddTo(MatrixXd& sum, const std::vector<int>& columns, const MatrixXd& part) {
  for (std::size_t a = 0; a < columns.size(); ++a) {
    for (std::size_t b = 0; b < columns.size(); ++b) {
      sum(columns[a], columns[b]) += part(a, b);
    }
  }
}

// The information of the parameters, and of the priors.
MatrixXd PriorInformation(const Problem& problem, const estimation::Layout& layout) {
  MatrixXd information = layout.prior_sd.cwiseAbs2().cwiseInverse().asDiagonal();
  estimation::RowEvaluator evaluator(problem, layout);
  for (const estimation::Term& term : problem.terms()) {
    const std::size_t source = term.source.index;
    if (!problem.sources()[source].options.is_prior) continue;
    const auto* rows = evaluator.Evaluate(term, layout.start, true);
    if (rows == nullptr) throw NumericalError(evaluator.trouble());
    AddTo(information, rows->columns, rows->jacobian.transpose() * rows->jacobian);
  }
  return information;
}

// For a cause that relaxes parameters: their own columns.
MatrixXd ParameterColumns(const LinearizedRun& run, const std::vector<std::string>& names,
                          const Candidate& candidate) {
  const std::vector<std::string> patterns = candidate.cause->relaxes(candidate.object);
  MatrixXd columns = MatrixXd::Zero(run.J.rows(), candidate.cause->coefficients());
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    const std::string& name = names[run.columns[c]];
    for (std::size_t p = 0; p < patterns.size(); ++p) {
      if (Matches(name, patterns[p])) {
        columns.col(p) -= run.J.col(c);
      }
    }
  }
  return columns;
}

MatrixXd ColumnsOf(const LinearizedRun& run, const std::vector<std::string>& names,
                   const std::vector<Candidate>& candidates) {
  Index count = 0;
  std::vector<simulation::Disturbance> disturbances;
  std::vector<Index> places;
  std::vector<std::pair<Index, const Candidate*>> widening;
  for (const Candidate& candidate : candidates) {
    if (candidate.cause->relaxes) {
      widening.emplace_back(count, &candidate);
    } else if (run.at.response) {
      auto own = candidate.cause->columns(run.at.trace, candidate.object, candidate.shape);
      for (std::size_t i = 0; i < own.size(); ++i) {
        places.push_back(count + i);
        disturbances.push_back(std::move(own[i]));
      }
    }
    count += candidate.cause->coefficients();
  }
  MatrixXd C = MatrixXd::Zero(run.J.rows(), count);
  if (!disturbances.empty()) {
    const MatrixXd made = run.at.response->Columns(disturbances);
    for (std::size_t i = 0; i < places.size(); ++i) {
      C.col(places[i]) = made.col(i);
    }
  }
  for (const auto& [first, candidate] : widening) {
    const MatrixXd own = ParameterColumns(run, names, *candidate);
    C.middleCols(first, own.cols()) = own;
  }
  return C;
}

}  // namespace

Values ValuesOf(const estimation::Result& fit) {
  Values values;
  for (const auto& block : fit.blocks) values.emplace(block.name, block.Values());
  return values;
}

std::vector<const RunSums*> PointersTo(const std::vector<RunSums>& sums) {
  std::vector<const RunSums*> pointers(sums.size());
  std::transform(sums.begin(), sums.end(), pointers.begin(),
                 [](const RunSums& each) { return &each; });
  return pointers;
}

LinearRuns::LinearRuns(const Campaign& campaign, std::vector<PreparedRun> runs, const Values& at)
    : runs_(std::move(runs)),
      problem_(ProblemAt(campaign, runs_, at)),
      layout_(problem_),
      prior_(PriorInformation(problem_, layout_)) {}

LinearizedRun LinearRuns::At(std::size_t run) const {
  const estimation::Term& term = problem_.terms()[run];
  estimation::RowEvaluator evaluator(problem_, layout_);
  const auto* rows = evaluator.Evaluate(term, layout_.start, true);
  if (rows == nullptr) throw NumericalError(evaluator.trouble());
  VectorXd x(term.entries.size());
  for (Index i = 0; i < x.size(); ++i) {
    x[i] = layout_.start[term.entries[i]];
  }
  LinearizedRun linear{LinearAt(runs_[run], x, rows->r), rows->columns, rows->jacobian, {}};
  simulation::Trace& trace = linear.at.trace;
  if (trace.head) trace.head->zero = trace.head->gap.rowwise().mean();
  linear.J_J = linear.J.transpose() * linear.J;
  return linear;
}

RunSums LinearRuns::SumsOf(const LinearizedRun& run,
                           const std::vector<Candidate>& candidates) const {
  const MatrixXd C = ColumnsOf(run, layout_.names, candidates);
  return {run.columns, run.J_J, C.transpose() * run.J, C.transpose() * C};
}

MatrixXd LinearRuns::Information(const std::vector<const RunSums*>& runs) const {
  constexpr double kRounding = 1e-9;  // of the information of a column
  MatrixXd H = prior_;
  MatrixXd C_J = MatrixXd::Zero(runs.front()->C_C.rows(), H.cols());
  MatrixXd C_C = MatrixXd::Zero(C_J.rows(), C_J.rows());
  for (const RunSums* run : runs) {
    AddTo(H, run->columns, run->J_J);
    for (std::size_t c = 0; c < run->columns.size(); ++c) {
      C_J.col(run->columns[c]) += run->C_J.col(c);
    }
    C_C += run->C_C;
  }
  // What nothing is known of and no run asks for.
  for (Index i = 0; i < H.rows(); ++i) {
    if (H(i, i) == 0.0) H(i, i) = 1.0;
  }
  const VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> factor(scale.asDiagonal() * H * scale.asDiagonal());
  const MatrixXd B = scale.asDiagonal() * C_J.transpose();
  MatrixXd left = C_C - B.transpose() * factor.solve(B);
  for (Index c = 0; c < left.rows(); ++c) {
    if (left(c, c) > kRounding * C_C(c, c)) continue;
    left.row(c).setZero();
    left.col(c).setZero();
  }
  return left;
}

}  // namespace abbe::diagnosis
