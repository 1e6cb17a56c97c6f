// Problem::Solve: approach the minimum, iterate to convergence, compute covariance and tests.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/linearization.h"
#include "estimation/passes.h"
#include "estimation/problem.h"
#include "estimation/trust_region.h"
#include "failure/failure.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The data determine a parameter when they halve its prior variance.
constexpr double kSeenShare = 0.5;

struct Information {
  MatrixXd data, prior;
};

Information Collect(const Problem& problem, const Linearization& at) {
  Information information{MatrixXd::Zero(at.prior.information.rows(), at.prior.information.cols()),
                          at.prior.information};
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    (problem.sources()[s].options.is_prior ? information.prior : information.data) +=
        at.sources[s].information;
  }
  return information;
}

void FillParameters(const Problem& problem, const Layout& layout, const VectorXd& x,
                    Result& result) {
  result.blocks = problem.blocks();
  Index entry = 0;
  for (ParameterBlock& block : result.blocks) {
    for (Parameter& parameter : block.entries) {
      const int column = layout.column_of_entry[entry];
      parameter.value = x[entry];
      parameter.uncertainty = column < 0 ? 0.0 : std::sqrt(result.covariance(column, column));
      ++entry;
    }
  }
}

SeenBy DeterminedBy(const Layout& layout, const Information& information, Index column,
                    double variance) {
  if (!std::isfinite(variance)) return SeenBy::kNothing;
  const double prior = information.prior(column, column);  // of this parameter alone
  if (prior > 0.0 && variance * prior > kSeenShare) return SeenBy::kPrior;
  const double tolerance = layout.tolerance[column];
  return prior <= 0.0 && variance > tolerance * tolerance ? SeenBy::kNothing : SeenBy::kData;
}

double Redundancy(Index rows, const MatrixXd& covariance, const MatrixXd& information) {
  return rows - covariance.cwiseProduct(information).sum();
}

void FillSources(const Problem& problem, const Linearization& at, const MatrixXd& covariance,
                 const Layout& layout, Result& result) {
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    const estimation::Source& source = problem.sources()[s];
    SourceResult& out = result.sources.emplace_back();
    out.name = source.name;
    out.is_prior = source.options.is_prior;
    out.rows = source.rows;
    out.chi_square = at.sources[s].chi_square;
    out.redundancy = Redundancy(out.rows, covariance, at.sources[s].information);
    if (!out.is_prior) result.redundancy += out.redundancy;
  }
  const Index priors = layout.prior_sd.array().isFinite().count();
  if (priors > 0) {
    SourceResult& out = result.sources.emplace_back();
    out.name = kPriorSource;
    out.is_prior = true;
    out.rows = priors;
    out.chi_square = at.prior.chi_square;
    out.redundancy = Redundancy(priors, covariance, at.prior.information);
    out.rms = std::sqrt(out.chi_square / priors);
  }
  for (const SourceResult& source : result.sources) {
    result.rows += source.rows;
    result.chi_square += source.chi_square;
  }
}

void Note(SourceResult& source, Index row, double normalised) {
  source.rms += normalised * normalised;
  if (std::abs(normalised) <= kOutlierAt) return;
  ++source.outlier_count;
  source.outliers.push_back({row, normalised});
}

void KeepWorst(std::vector<Outlier>& outliers) {
  std::stable_sort(outliers.begin(), outliers.end(), [](const Outlier& a, const Outlier& b) {
    return std::abs(a.normalised) > std::abs(b.normalised);
  });
  if (outliers.size() > kMostOutliers) outliers.resize(kMostOutliers);
}

void FillOutliers(const Problem& problem, const Layout& layout, const VectorXd& x, Result& result) {
  VisitRows(problem, layout, x, false, [&](const WhitenedRows& rows) {
    SourceResult& source = result.sources[rows.term->source.index];
    for (Index i = 0; i < rows.r.size(); ++i) Note(source, rows.term->first_row + i, rows.r[i]);
    if (source.outliers.size() > 2 * kMostOutliers) KeepWorst(source.outliers);
  });
  for (std::size_t s = 0; s < problem.sources().size(); ++s) {
    SourceResult& source = result.sources[s];
    KeepWorst(source.outliers);
    if (source.rows > 0) source.rms = std::sqrt(source.rms / source.rows);
  }
}

bool IsLinear(const Problem& problem) {
  return std::ranges::all_of(problem.terms(), [&](const Term& term) {
    const SourceOptions& options = problem.sources()[term.source.index].options;
    return term.residual->IsLinear() && options.loss.kind == RobustLoss::Kind::kNone;
  });
}

}  // namespace

Result Problem::Solve(const SolveOptions& options, Linearization* at) const {
  const Layout layout(*this);
  VectorXd x = layout.start;
  Linearization start = Linearize(*this, layout, x, options.threads);
  if (!start.trouble.empty()) {
    throw NumericalError(
        fmt::format("the fit cannot start: {}; check the starting values", start.trouble));
  }
  Result result;
  if (layout.columns() > 0 && !IsLinear(*this) &&
      JacobianBytes(*this, layout) <= options.jacobian_bytes) {
    result.iterations = ApproachMinimum(*this, layout, options, x);
    start = Linearize(*this, layout, x, options.threads);
  }
  Minimum minimum = FindMinimum(*this, layout, options, std::move(x), std::move(start));
  result.iterations += minimum.passes;

  const Information information = Collect(*this, minimum.at);
  const PosteriorCovariance covariance = InvertInformation(information.data, information.prior);
  result.names = layout.names;
  result.covariance = covariance.matrix;
  if (options.weak_directions) {
    result.condition = ScaledCondition(information.data);
    result.weak_directions =
        FindWeakDirections(information.data, information.prior, layout.tolerance, layout.names);
  } else if (covariance.undetermined > 0) {
    result.weak_directions = FindUndeterminedDirections(information.data, information.prior,
                                                        layout.tolerance, layout.names);
  }
  for (Index c = 0; c < layout.columns(); ++c) {
    result.seen_by.push_back(DeterminedBy(layout, information, c, covariance.matrix(c, c)));
  }
  FillParameters(*this, layout, minimum.x, result);
  FillSources(*this, minimum.at, covariance.determined, layout, result);
  FillOutliers(*this, layout, minimum.x, result);
  result.freedom = result.rows - (layout.columns() - covariance.undetermined);
  result.status =
      covariance.undetermined > 0 ? Result::Status::kUndetermined : Result::Status::kConverged;
  if (at != nullptr) *at = std::move(minimum.at);
  return result;
}

}  // namespace abbe::estimation
