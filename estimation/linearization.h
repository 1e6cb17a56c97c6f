// A problem made linear at one point: residuals and derivatives of the free parameters, whitened.
//
// Two views of the same rows:
//   VisitRows    hands out the whitened rows of one residual after the other (for a projection, a
//                score for a candidate cause),
//   Linearize    sums them up to J'J, J'r and chi-square per source: n x n each, no matter how many
//                rows there are. It runs on all cores and is the same for any number of them.
//
//   const Layout layout(problem);
//   const Linearization at = Linearize(problem, layout, layout.start, threads);
//   at.sources[0].information;  at.Gradient();
//
// A row of a robust source enters with the square root of its weight (robust_loss.h), so J'J and
// J'r are those of one step of iteratively reweighted least squares. Shapes: x all entries of all
// blocks in order, held ones included; columns are the free ones. Failure: a residual that is not
// finite, or throws NumericalError, ends in `trouble` (source, row, parameter in words); the sums
// are then not to be used.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "estimation/problem.h"

namespace abbe::estimation {

// Which entry is which column, and what the priors of the free entries are.
struct Layout {
  explicit Layout(const Problem& problem);

  Eigen::VectorXd start;             // values of all entries
  std::vector<int> column_of_entry;  // -1: held
  std::vector<int> entry_of_column;
  std::vector<std::string> names;                // of the columns
  Eigen::VectorXd nominal, prior_sd, tolerance;  // of the columns
  Eigen::Index columns() const { return static_cast<Eigen::Index>(names.size()); }
};

// The whitened rows of one residual. `r` = value / sigma; weights of a robust loss are not applied.
struct WhitenedRows {
  const Term* term = nullptr;
  Eigen::VectorXd r;
  std::vector<int> columns;  // of the problem, one for each column of `jacobian`
  RowMatrix jacobian;        // free parameters only; 0 columns when not asked for
};

// Evaluates terms one after the other, keeping its memory from one to the next.
class RowEvaluator {
 public:
  RowEvaluator(const Problem& problem, const Layout& layout) : problem_(problem), layout_(layout) {}
  // nullptr when the rows are unusable; trouble() then says why.
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

// In the order of adding. NumericalError when a residual is not usable.
void VisitRows(const Problem& problem, const Layout& layout, const Eigen::VectorXd& x,
               bool with_jacobian, const std::function<void(const WhitenedRows&)>& visitor);

struct SourceSums {
  Eigen::MatrixXd information;  // J'WJ
  Eigen::VectorXd gradient;     // J'Wr
  double chi_square = 0.0;      // r'Wr
  double cost = 0.0;            // sum rho(r) / 2: what the solve makes small
};

struct Linearization {
  std::vector<SourceSums> sources;  // as in the problem
  SourceSums prior;                 // the parameters' own priors
  std::string trouble;

  double Cost() const;
  Eigen::VectorXd Gradient() const;
};

Linearization Linearize(const Problem& problem, const Layout& layout, const Eigen::VectorXd& x,
                        int threads);

}  // namespace abbe::estimation
