// A problem linearised at one point: whitened residuals and their Jacobian by the free parameters.
//
// Two views of the same rows:
//   VisitRows    passes the whitened rows of one residual after the other to a visitor (a
//                projection, a score test of a candidate cause).
//   Linearize    sums them to J'WJ, J'Wr and chi-square per source: n x n each, for any number of
//                rows. The sums are the same for any number of threads.
//
//   const Layout layout(problem);
//   const Linearization at = Linearize(problem, layout, layout.start, threads);
//   at.sources[0].information;  at.Gradient();
//
// W holds the weights of the robust loss (robust_loss.h), 1 for a source without one, so the sums
// are those of one step of iteratively reweighted least squares.
// Units: residuals in standard deviations; columns per unit of their parameter. Shapes: x has all
// entries of all blocks in order, held ones included; columns are the free ones.
// Failure: when a residual is not finite or throws NumericalError, Linearize says so in `trouble`
// (source, row, parameter) and its sums are not to be used; VisitRows throws NumericalError.
// Source: iteratively reweighted least squares, Holland and Welsch (1977).
// Validity: first order at x.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "estimation/problem.h"

namespace abbe::estimation {

// The map between entries and columns, and the priors of the free entries.
struct Layout {
  explicit Layout(const Problem& problem);

  Eigen::VectorXd start;             // values of all entries
  std::vector<int> column_of_entry;  // -1: held
  std::vector<int> entry_of_column;
  std::vector<std::string> names;                // one per column
  Eigen::VectorXd nominal, prior_sd, tolerance;  // one per column
  Eigen::Index columns() const { return names.size(); }
};

// The whitened rows of one residual, r = value / sigma, before the weights of a robust loss.
struct WhitenedRows {
  const Term* term = nullptr;
  Eigen::VectorXd r;
  std::vector<int> columns;  // of the layout, one for each column of `jacobian`
  RowMatrix jacobian;        // free parameters only; 0 columns without derivatives
};

// Evaluates terms one after the other and reuses its memory.
class RowEvaluator {
 public:
  RowEvaluator(const Problem& problem, const Layout& layout) : problem_(problem), layout_(layout) {}
  // nullptr when a row is not finite or the residual throws NumericalError; trouble() says why.
  const WhitenedRows* Evaluate(const Term& term, const Eigen::VectorXd& x, bool with_jacobian);
  const std::string& trouble() const { return trouble_; }

 private:
  bool Whiten(const Term& term, bool with_jacobian);

  const Problem& problem_;
  const Layout& layout_;
  Eigen::VectorXd inputs_;
  RowMatrix full_;
  WhitenedRows rows_;
  std::string trouble_;
};

// Visits the terms in the order in which they were added.
void VisitRows(const Problem& problem, const Layout& layout, const Eigen::VectorXd& x,
               bool with_jacobian, const std::function<void(const WhitenedRows&)>& visitor);

struct SourceSums {
  Eigen::MatrixXd information;  // J'WJ
  Eigen::VectorXd gradient;     // J'Wr
  double chi_square = 0.0;      // r'Wr
  double cost = 0.0;            // sum rho(r) / 2: what the solve minimises
};

struct Linearization {
  std::vector<SourceSums> sources;  // as in the problem
  SourceSums prior;                 // the parameters' own priors
  std::string trouble;              // empty when all rows are usable

  // Sums over the sources and the prior.
  double Cost() const;
  // J'Wr.
  Eigen::VectorXd Gradient() const;
};

// `threads` 0: all.
Linearization Linearize(const Problem& problem, const Layout& layout, const Eigen::VectorXd& x,
                        int threads);

}  // namespace abbe::estimation
