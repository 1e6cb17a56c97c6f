#include "diagnosis/linear_runs.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
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

// Indices of the entries that are not zero: a cause of many functions acts in few of them in a run.
std::vector<int> NotZero(const VectorXd& values) {
  std::vector<int> indices;
  for (Index i = 0; i < values.size(); ++i) {
    if (values[i] != 0.0) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

std::vector<int> Union(const std::vector<int>& sorted, std::vector<int> more) {
  std::ranges::sort(more);
  std::vector<int> both;
  std::ranges::set_union(sorted, more, std::back_inserter(both));
  return both;
}

// Where each index stands in `sorted`, which has them all.
std::vector<int> PlacesIn(const std::vector<int>& sorted, const std::vector<int>& indices) {
  std::vector<int> places(indices.size());
  std::ranges::transform(indices, places.begin(), [&](int index) {
    return static_cast<int>(std::ranges::lower_bound(sorted, index) - sorted.begin());
  });
  return places;
}

// The columns whose unknowns the priors tie to others.
std::vector<int> Tied(const MatrixXd& information) {
  std::vector<int> tied;
  for (Index i = 0; i < information.cols(); ++i) {
    const auto others = (information.col(i).array() != 0.0).count() - (information(i, i) != 0.0);
    if (others > 0) tied.push_back(static_cast<int>(i));
  }
  return tied;
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
      prior_(PriorInformation(problem_, layout_)),
      tied_(Tied(prior_)) {}

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
  RunSums sums{.columns = run.columns,
               .acting = NotZero(C.colwise().squaredNorm().transpose()),
               .coefficients = C.cols(),
               .J_J = run.J_J};
  const MatrixXd acting = C(Eigen::all, sums.acting);
  sums.C_J = acting.transpose() * run.J;
  sums.C_C = acting.transpose() * acting;
  return sums;
}

MatrixXd LinearRuns::Information(const std::vector<const RunSums*>& runs) const {
  constexpr double kRounding = 1e-9;  // of the information of a column
  // An unknown of a run that is left out, tied to no other, changes nothing.
  std::vector<int> taken = tied_, acting;
  for (const RunSums* run : runs) {
    taken = Union(taken, run->columns);
    acting = Union(acting, run->acting);
  }
  MatrixXd H = prior_(taken, taken);
  MatrixXd C_J = MatrixXd::Zero(std::ssize(acting), H.cols());
  MatrixXd C_C = MatrixXd::Zero(C_J.rows(), C_J.rows());
  for (const RunSums* run : runs) {
    const std::vector<int> columns = PlacesIn(taken, run->columns);
    const std::vector<int> rows = PlacesIn(acting, run->acting);
    AddTo(H, columns, run->J_J);
    C_J(rows, columns) += run->C_J;
    C_C(rows, rows) += run->C_C;
  }
  // What nothing is known of and no run asks for.
  for (Index i = 0; i < H.rows(); ++i) {
    if (H(i, i) == 0.0) H(i, i) = 1.0;
  }
  const VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  H.array().colwise() *= scale.array();
  H.array().rowwise() *= scale.transpose().array();
  const Eigen::LLT<MatrixXd> factor(H);
  const MatrixXd half = factor.matrixL().solve(scale.asDiagonal() * C_J.transpose());
  MatrixXd left = C_C - half.transpose() * half;
  for (Index c = 0; c < left.rows(); ++c) {
    if (left(c, c) > kRounding * C_C(c, c)) continue;
    left.row(c).setZero();
    left.col(c).setZero();
  }
  const Index count = runs.front()->coefficients;
  MatrixXd of_all = MatrixXd::Zero(count, count);
  of_all(acting, acting) = left;
  return of_all;
}

}  // namespace abbe::diagnosis
