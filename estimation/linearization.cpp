#include "estimation/linearization.h"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "estimation/in_parallel.h"
#include "failure/interruption.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Each source is summed in this many pieces, which are added in order: the result is the same to
// the last bit for any number of threads.
constexpr std::size_t kPieces = 8;

void Clear(SourceSums& sums, Index columns) {
  sums.information.setZero(columns, columns);
  sums.gradient.setZero(columns);
}

void Add(SourceSums& to, const SourceSums& from) {
  to.information += from.information;
  to.gradient += from.gradient;
  to.chi_square += from.chi_square;
  to.cost += from.cost;
}

// Adds the rows of one residual; its sums go to the columns of its own parameters.
class Accumulator {
 public:
  explicit Accumulator(SourceSums& sums) : sums_(sums) {}

  void Add(const WhitenedRows& rows, const RobustLoss& loss) {
    r_ = rows.r;
    const bool robust = loss.kind != RobustLoss::Kind::kNone;
    if (robust) j_ = rows.jacobian;
    for (Index i = 0; i < r_.size(); ++i) {
      sums_.cost += 0.5 * loss.Rho(r_[i]);
      if (!robust) continue;
      const double root = std::sqrt(loss.Weight(r_[i]));
      r_[i] *= root;
      j_.row(i) *= root;
    }
    sums_.chi_square += r_.squaredNorm();
    Scatter(robust ? j_ : rows.jacobian, rows.columns);
  }

 private:
  void Scatter(const RowMatrix& j, const std::vector<int>& columns) {
    const Index n = j.cols();
    if (n == 0) return;
    square_.setZero(n, n);
    square_.selfadjointView<Eigen::Lower>().rankUpdate(j.transpose());
    slope_.noalias() = j.transpose() * r_;
    for (Index b = 0; b < n; ++b) {
      const int column_b = columns[b];
      sums_.gradient[column_b] += slope_[b];
      for (Index a = b; a < n; ++a) {
        const int column_a = columns[a];
        sums_.information(column_a, column_b) += square_(a, b);
        if (a > b) sums_.information(column_b, column_a) += square_(a, b);
      }
    }
  }

  SourceSums& sums_;
  VectorXd r_, slope_;
  RowMatrix j_;
  Eigen::MatrixXd square_;
};

std::string NameOfEntry(const Problem& problem, int entry) {
  for (const ParameterBlock& block : problem.blocks()) {
    if (entry < block.size()) return block.FullName(entry);
    entry -= static_cast<int>(block.size());
  }
  return "?";
}

// One piece of the terms of one source.
struct Piece {
  std::vector<const Term*> terms;
  SourceSums sums;
  std::string trouble;
};

std::vector<std::vector<const Term*>> TermsOfSources(const Problem& problem) {
  std::vector<std::vector<const Term*>> terms(problem.sources().size());
  for (const Term& term : problem.terms()) {
    terms[term.source.index].push_back(&term);
  }
  return terms;
}

std::vector<Piece> Divide(const std::vector<const Term*>& terms) {
  std::vector<Piece> pieces(std::min(kPieces, terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    pieces[i * pieces.size() / terms.size()].terms.push_back(terms[i]);
  }
  return pieces;
}

void Sum(const Problem& problem, const Layout& layout, const VectorXd& x, Piece& piece) {
  Clear(piece.sums, layout.columns());
  RowEvaluator evaluator(problem, layout);
  Accumulator accumulator(piece.sums);
  for (const Term* term : piece.terms) {
    const WhitenedRows* rows = evaluator.Evaluate(*term, x, true);
    if (rows == nullptr) {
      piece.trouble = evaluator.trouble();
      return;
    }
    const Source& source = problem.sources()[term->source.index];
    accumulator.Add(*rows, source.options.loss);
  }
}

// The sums of a source from those of its pieces, in order; `trouble` of the first that has one.
SourceSums Joined(std::vector<Piece>& pieces, Index columns, std::string& trouble) {
  SourceSums sums;
  if (pieces.empty()) Clear(sums, columns);
  for (Piece& piece : pieces) {
    if (trouble.empty()) trouble = piece.trouble;
    if (&piece == &pieces.front()) {
      sums = std::move(piece.sums);
    } else {
      Add(sums, piece.sums);
    }
  }
  return sums;
}

SourceSums PriorSums(const Layout& layout, const VectorXd& x) {
  SourceSums sums;
  Clear(sums, layout.columns());
  for (Index c = 0; c < layout.columns(); ++c) {
    if (!std::isfinite(layout.prior_sd[c])) continue;
    const double sd = layout.prior_sd[c];
    const double off = (x[layout.entry_of_column[c]] - layout.nominal[c]) / sd;
    sums.information(c, c) = 1.0 / (sd * sd);
    sums.gradient[c] = off / sd;
    sums.chi_square += off * off;
  }
  sums.cost = 0.5 * sums.chi_square;
  return sums;
}

}  // namespace

Layout::Layout(const Problem& problem) {
  std::vector<double> values, nominals, priors, tolerances;
  for (const ParameterBlock& block : problem.blocks()) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const Parameter& entry = block.entries[i];
      values.push_back(entry.value);
      column_of_entry.push_back(entry.held ? -1 : static_cast<int>(names.size()));
      if (entry.held) continue;
      entry_of_column.push_back(static_cast<int>(values.size()) - 1);
      names.push_back(block.FullName(i));
      nominals.push_back(entry.nominal);
      priors.push_back(entry.prior_sd);
      tolerances.push_back(entry.tolerance);
    }
  }
  const auto vector = [](const std::vector<double>& v) {
    return VectorXd(Eigen::Map<const VectorXd>(v.data(), v.size()));
  };
  start = vector(values);
  nominal = vector(nominals);
  prior_sd = vector(priors);
  tolerance = vector(tolerances);
}

const WhitenedRows* RowEvaluator::Evaluate(const Term& term, const VectorXd& x,
                                           bool with_jacobian) {
  const Index n = term.entries.size();
  inputs_.resize(n);
  for (Index i = 0; i < n; ++i) inputs_[i] = x[term.entries[i]];
  rows_.term = &term;
  rows_.r.resize(term.residual->Rows());
  if (with_jacobian) full_.resize(term.residual->Rows(), n);
  try {
    term.residual->Evaluate(inputs_, rows_.r, with_jacobian ? &full_ : nullptr);
  } catch (const NumericalError& error) {
    const Source& source = problem_.sources()[term.source.index];
    trouble_ = fmt::format("source '{}', rows {} to {}: {}", source.name, term.first_row,
                           term.first_row + term.residual->Rows() - 1, error.what());
    return nullptr;
  }
  return Whiten(term, with_jacobian) ? &rows_ : nullptr;
}

bool RowEvaluator::Whiten(const Term& term, bool with_jacobian) {
  const std::string& source = problem_.sources()[term.source.index].name;
  const VectorXd& sd = term.standard_deviation;
  rows_.columns.clear();
  std::vector<Index> used;
  for (Index i = 0; with_jacobian && i < std::ssize(term.entries); ++i) {
    const int column = layout_.column_of_entry[term.entries[i]];
    if (column < 0) continue;
    rows_.columns.push_back(column);
    used.push_back(i);
  }
  const Index n = used.size();
  rows_.jacobian.resize(rows_.r.size(), n);
  for (Index row = 0; row < rows_.r.size(); ++row) {
    const double whiten = 1.0 / sd[sd.size() == 1 ? 0 : row];
    rows_.r[row] *= whiten;
    if (!std::isfinite(rows_.r[row])) {
      trouble_ = fmt::format("source '{}', row {}: the residual is not finite", source,
                             term.first_row + row);
      return false;
    }
    for (Index c = 0; c < n; ++c) {
      const Index input = used[c];
      const double slope = full_(row, input) * whiten;
      rows_.jacobian(row, c) = slope;
      if (!std::isfinite(slope)) {
        const int entry = term.entries[input];
        trouble_ = fmt::format("source '{}', row {}: the derivative by {} is not finite", source,
                               term.first_row + row, NameOfEntry(problem_, entry));
        return false;
      }
    }
  }
  return true;
}

void VisitRows(const Problem& problem, const Layout& layout, const VectorXd& x, bool with_jacobian,
               const std::function<void(const WhitenedRows&)>& visitor) {
  RowEvaluator evaluator(problem, layout);
  for (const Term& term : problem.terms()) {
    const WhitenedRows* rows = evaluator.Evaluate(term, x, with_jacobian);
    if (rows == nullptr) throw NumericalError(evaluator.trouble());
    visitor(*rows);
  }
}

double Linearization::Cost() const {
  double cost = prior.cost;
  for (const SourceSums& source : sources) cost += source.cost;
  return cost;
}

VectorXd Linearization::Gradient() const {
  VectorXd gradient = prior.gradient;
  for (const SourceSums& source : sources) gradient += source.gradient;
  return gradient;
}

Linearization Linearize(const Problem& problem, const Layout& layout, const VectorXd& x,
                        int threads) {
  const auto terms = TermsOfSources(problem);
  std::vector<std::string> troubles(terms.size());
  Linearization result;
  result.prior = PriorSums(layout, x);
  result.sources.resize(terms.size());
  const auto sum = [&] {
    InParallel(terms.size(), [&](std::size_t s) {
      MayBeInterrupted();
      std::vector<Piece> pieces = Divide(terms[s]);
      InParallel(pieces.size(), [&](std::size_t i) { Sum(problem, layout, x, pieces[i]); });
      result.sources[s] = Joined(pieces, layout.columns(), troubles[s]);
    });
  };
  if (threads > 0) {
    tbb::task_arena(std::min(threads, tbb::info::default_concurrency())).execute(sum);
  } else {
    sum();
  }
  for (std::string& trouble : troubles) {
    if (result.trouble.empty()) result.trouble = std::move(trouble);
  }
  return result;
}

}  // namespace abbe::estimation
