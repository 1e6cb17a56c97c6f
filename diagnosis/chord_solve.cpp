#include "diagnosis/chord_solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/extended_run.h"
#include "diagnosis/remembering_run.h"
#include "estimation/extended_residual.h"
#include "estimation/in_parallel.h"
#include "estimation/weak_directions.h"
#include "failure/failure.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd InputsOf(const estimation::Term& term, const VectorXd& x) {
  VectorXd inputs(static_cast<Index>(term.entries.size()));
  for (Index i = 0; i < inputs.size(); ++i) {
    inputs[i] = x[term.entries[static_cast<std::size_t>(i)]];
  }
  return inputs;
}

// A term of a run, taken apart: a run that knows its derivatives, and columns of causes.
struct KnownTerm {
  const KnownRows* run = nullptr;  // null: it does not
  const estimation::ExtendedResidual* extended = nullptr;

  Index causes() const { return extended == nullptr ? 0 : extended->columns().cols(); }
};

KnownTerm PartsOf(const estimation::Term& term) {
  KnownTerm known;
  known.extended = dynamic_cast<const estimation::ExtendedResidual*>(term.residual.get());
  const auto* base = known.extended == nullptr ? term.residual.get() : known.extended->base().get();
  known.run = dynamic_cast<const KnownRows*>(base);
  if (term.standard_deviation.size() != 1 || term.standard_deviation[0] != 1.0) {
    known.run = nullptr;
  }
  return known;
}

// The free ones among the inputs of a term, and their columns.
struct FreeInputs {
  std::vector<Index> inputs;
  std::vector<int> columns;

  FreeInputs(const estimation::Term& term, const estimation::Layout& layout) {
    for (std::size_t i = 0; i < term.entries.size(); ++i) {
      const int column = layout.column_of_entry[static_cast<std::size_t>(term.entries[i])];
      if (column < 0) continue;
      inputs.push_back(static_cast<Index>(i));
      columns.push_back(column);
    }
  }
};

class Chords {
 public:
  Chords(const estimation::Problem& problem, const estimation::Layout& layout)
      : problem_(problem), layout_(layout) {}

  // NumericalError where a run cannot be simulated; false: a run does not know its derivatives.
  bool SumAt(const VectorXd& x, FitSums& sums) const {
    const Index n = layout_.columns();
    sums.data_information = MatrixXd::Zero(n, n);
    sums.data_gradient = VectorXd::Zero(n);
    sums.cost = 0.0;
    const auto& terms = problem_.terms();
    std::vector<std::optional<RunSums>> of_runs(terms.size());
    estimation::InParallel(terms.size(), [&](std::size_t t) {
      if (!IsOfPrior(terms[t])) of_runs[t] = SumsOf(terms[t], x);
    });
    for (std::size_t t = 0; t < terms.size(); ++t) {
      if (IsOfPrior(terms[t])) continue;
      if (!of_runs[t]) return false;
      const auto& [columns, square, slope, cost] = *of_runs[t];
      sums.data_information(columns, columns) += square;
      sums.data_gradient(columns) += slope;
      sums.cost += cost;
    }
    sums.information = sums.data_information;
    sums.gradient = sums.data_gradient;
    sums.prior = layout_.prior_sd.cwiseAbs2().cwiseInverse();
    sums.information.diagonal() += sums.prior;
    for (Index c = 0; c < n; ++c) {
      const double off =
          x[layout_.entry_of_column[static_cast<std::size_t>(c)]] - layout_.nominal[c];
      sums.gradient[c] += sums.prior[c] * off;
      sums.cost += 0.5 * sums.prior[c] * off * off;
    }
    estimation::RowEvaluator evaluator(problem_, layout_);
    for (const estimation::Term& term : problem_.terms()) {
      if (!IsOfPrior(term)) continue;
      const auto* rows = evaluator.Evaluate(term, x, true);
      if (rows == nullptr) return false;
      sums.information(rows->columns, rows->columns) += rows->jacobian.transpose() * rows->jacobian;
      sums.gradient(rows->columns) += rows->jacobian.transpose() * rows->r;
      sums.cost += 0.5 * rows->r.squaredNorm();
    }
    return true;
  }

  // Scatter of the rows of runs, in units of their noise.
  double ScatterAt(const FitSums& sums) const {
    double rows = 0.0;
    for (const estimation::Source& source : problem_.sources()) {
      if (!source.options.is_prior) rows += static_cast<double>(source.rows);
    }
    return std::sqrt(2.0 * sums.cost / std::max(rows, 1.0));
  }

 private:
  bool IsOfPrior(const estimation::Term& term) const {
    return problem_.sources()[static_cast<std::size_t>(term.source.index)].options.is_prior;
  }

  struct RunSums {
    std::vector<int> columns;
    MatrixXd square;
    VectorXd slope;
    double cost;
  };

  // Empty: the run does not know its derivatives.
  std::optional<RunSums> SumsOf(const estimation::Term& term, const VectorXd& x) const {
    const KnownTerm parts = PartsOf(term);
    if (parts.run == nullptr) return {};
    const VectorXd inputs = InputsOf(term, x);
    const Index own = inputs.size() - parts.causes();
    const VectorXd at = inputs.head(own);
    VectorXd r(term.residual->Rows());
    term.residual->Evaluate(inputs, r, nullptr);
    if (!r.allFinite()) return {};
    const auto known = parts.run->KnownAt(at);
    MatrixXd square(inputs.size(), inputs.size());
    VectorXd slope(inputs.size());
    square.topLeftCorner(own, own) = known->square;
    slope.head(own).noalias() = known->jacobian.transpose() * r;
    if (parts.causes() > 0) {
      const MatrixXd& C = parts.extended->columns();
      const MatrixXd cross = -known->jacobian.transpose() * C;
      square.topRightCorner(own, C.cols()) = cross;
      square.bottomLeftCorner(C.cols(), own) = cross.transpose();
      square.bottomRightCorner(C.cols(), C.cols()).noalias() = C.transpose() * C;
      slope.tail(C.cols()).noalias() = -C.transpose() * r;
    }
    const FreeInputs free(term, layout_);
    return RunSums{free.columns, square(free.inputs, free.inputs), slope(free.inputs),
                   0.5 * r.squaredNorm()};
  }

  const estimation::Problem& problem_;
  const estimation::Layout& layout_;
};

// The step to the minimum, and its length in standard uncertainties; NaN: there is none.
struct Step {
  VectorXd step;
  double length;
};

Step StepFrom(const FitSums& sums) {
  const VectorXd scale = sums.information.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * sums.information * scale.asDiagonal();
  const Eigen::LLT<MatrixXd> factor(scaled);
  VectorXd step = -scale.cwiseProduct(factor.solve(VectorXd(scale.cwiseProduct(sums.gradient))));
  const double square = -sums.gradient.dot(step);
  if (factor.info() != Eigen::Success) return {std::move(step), std::nan("")};
  return {std::move(step), std::sqrt(square)};
}

void Fill(const estimation::Problem& problem, const estimation::Layout& layout, const VectorXd& x,
          estimation::Result& result) {
  result.names = layout.names;
  result.blocks = problem.blocks();
  Index entry = 0;
  for (estimation::ParameterBlock& block : result.blocks) {
    for (estimation::Parameter& parameter : block.entries) {
      const int column = layout.column_of_entry[static_cast<std::size_t>(entry)];
      parameter.value = x[entry];
      parameter.uncertainty = column < 0 ? 0.0 : std::sqrt(result.covariance(column, column));
      ++entry;
    }
  }
  result.status = estimation::Result::Status::kConverged;
}

// Empty: a step is refused.
std::optional<ChordMinimum> Minimise(const estimation::Problem& problem, double settled) {
  constexpr int kMostPasses = 12;
  constexpr double kMostScatter = 10.0, kRounding = 1e-11;
  const estimation::Layout layout(problem);
  const Chords chords(problem, layout);
  VectorXd x = layout.start;
  ChordMinimum found;
  if (!chords.SumAt(x, found.at)) return {};
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const Step next = StepFrom(found.at);
    const double scatter = std::clamp(chords.ScatterAt(found.at), 1.0, kMostScatter);
    if (!std::isfinite(next.length)) return {};
    const bool is_there = next.length <= settled * scatter;
    if (pass > 0 && is_there) {
      const auto covariance = estimation::InvertInformation(
          found.at.data_information, found.at.information - found.at.data_information);
      if (covariance.undetermined > 0) return {};
      found.result.covariance = covariance.matrix;
      Fill(problem, layout, x, found.result);
      return found;
    }
    VectorXd trial = x;
    for (Index c = 0; c < next.step.size(); ++c) {
      trial[layout.entry_of_column[static_cast<std::size_t>(c)]] += next.step[c];
    }
    FitSums there;
    if (!chords.SumAt(trial, there)) return {};
    if (there.cost > found.at.cost * (1.0 + kRounding)) {
      if (!is_there) return {};
      continue;  // nothing is nearer
    }
    x = std::move(trial);
    found.at = std::move(there);
  }
  return {};
}

}  // namespace

FitSums SumsOf(const estimation::Problem& problem, const estimation::Linearization& at) {
  FitSums sums;
  sums.information = at.prior.information;
  sums.gradient = at.prior.gradient;
  sums.prior = at.prior.information.diagonal();
  sums.data_information = MatrixXd::Zero(sums.information.rows(), sums.information.cols());
  sums.data_gradient = VectorXd::Zero(sums.gradient.size());
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    sums.information += at.sources[s].information;
    sums.gradient += at.sources[s].gradient;
    if (problem.sources()[s].options.is_prior) continue;
    sums.data_information += at.sources[s].information;
    sums.data_gradient += at.sources[s].gradient;
  }
  sums.cost = at.Cost();
  return sums;
}

std::optional<FitSums> KnownSumsAt(const estimation::Problem& problem, const VectorXd& x) {
  const estimation::Layout layout(problem);
  FitSums sums;
  if (!Chords(problem, layout).SumAt(x, sums)) return {};
  return sums;
}

std::optional<ChordMinimum> MinimumByChords(const estimation::Problem& problem, double settled) {
  try {
    return Minimise(problem, settled);
  } catch (const NumericalError&) {
    return {};
  }
}

RunDerivatives DerivativesAt(const estimation::Problem& problem, const estimation::Layout& layout,
                             const estimation::Term& term, const VectorXd& x) {
  const KnownTerm parts = PartsOf(term);
  if (parts.run == nullptr) {
    estimation::RowEvaluator evaluator(problem, layout);
    const auto* rows = evaluator.Evaluate(term, x, true);
    if (rows == nullptr) throw NumericalError(evaluator.trouble());
    MatrixXd both(rows->r.size(), rows->jacobian.cols() + 1);
    both << rows->jacobian, rows->r;
    return {rows->columns, std::move(both)};
  }
  const VectorXd inputs = InputsOf(term, x);
  const Index own = inputs.size() - parts.causes(), rows = term.residual->Rows();
  const auto known = parts.run->KnownAt(inputs.head(own));
  VectorXd r(rows);
  term.residual->Evaluate(inputs, r, nullptr);
  const FreeInputs free(term, layout);
  RunDerivatives seen{{}, MatrixXd(rows, static_cast<Index>(free.inputs.size()) + 1)};
  for (std::size_t i = 0; i < free.inputs.size(); ++i) {
    const Index input = free.inputs[i];
    auto column = seen.both.col(static_cast<Index>(seen.columns.size()));
    if (input < own) {
      column = known->jacobian.col(input);
    } else {
      column = -parts.extended->columns().col(input - own);
    }
    // A circle sees the functions of an axis that stands at one place.
    if (!column.isZero(0.0)) seen.columns.push_back(free.columns[i]);
  }
  seen.both.conservativeResize(Eigen::NoChange, static_cast<Index>(seen.columns.size()) + 1);
  seen.both.rightCols<1>() = r;
  return seen;
}

}  // namespace abbe::diagnosis
