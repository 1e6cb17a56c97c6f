// Problem -> Solve -> Result: weighted nonlinear least squares with named parameters and priors.
//
// Finds the parameters x that minimise
//
//   sum_i rho(r_i(x) / sigma_i)  +  sum_j ((x_j - nominal_j) / prior_j)^2
//
// over all rows i and parameters j, with rho(t) = t^2 unless the row's source has a robust loss.
// Every row is whitened by its stated standard deviation sigma_i, so the minimum is a chi-square,
// the inverse of J'J is the covariance in the parameters' own units, and weak directions are
// measured against the noise (weak_directions.h).
//
//   Problem problem;
//   const BlockId line = problem.Add({"line", {"um", 1e-6}, {{"offset"}, {"slope", 0.0, 1e-3}}});
//   const SourceId gauge = problem.AddSource("gauge", {.loss = RobustLoss::Huber()});
//   problem.Add(gauge, std::make_shared<LineResidual>(at, y), {line}, 0.1e-6);
//   const Result result = problem.Solve();
//   fmt::print("{}", result.Report());
//   result.Value("line.slope");  result.Uncertainty("line.slope");
//
// A source is a named group of rows (a run, an instrument); the result has chi-square and
// redundancy per source. `is_prior` marks a source that is prior knowledge, not data: smoothness, a
// certificate.
// The problem itself adds the priors of the parameters, as source "prior".
//
// Method: while the Jacobian fits in `jacobian_bytes`, Levenberg-Marquardt (Ceres), finished by
// passes over the rows that keep only the n x n normal equations (passes.h). A larger problem is
// solved by the passes alone: memory does not grow with the rows, but the start must be near the
// solution (solve a subsample first). The solve has converged when the next step is shorter than
// `settled` standard uncertainties; where the rows scatter beyond their stated noise the bound
// grows with the scatter, at most ten times.
// Units: SI; sigma in the unit of the residual. Shapes: the x of a residual is its inputs,
// concatenated.
// Failure: InputError for a wrong set-up (names, sizes, deviations). NumericalError from Solve when
// a residual or a derivative is not finite at the start or the iteration does not converge; it
// names the source and the parameter. Undetermined parameters are no failure: the result is then
// not usable and names them.
// Source: Bjorck, Numerical Methods for Least Squares Problems (1996); Ceres Solver for the trust
// region.
// Validity: up to about 1000 parameters.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "estimation/residual.h"
#include "estimation/result.h"
#include "estimation/robust_loss.h"

namespace abbe::estimation {

struct Linearization;

struct BlockId {
  int index = 0;
};
struct SourceId {
  int index = 0;
};

// The entries [first, first + count) of a block; count -1: to its end.
struct Input {
  Input(BlockId id, int first_entry = 0, int entry_count = -1)  // NOLINT: a block is an input
      : block(id), first(first_entry), count(entry_count) {}
  BlockId block;
  int first;
  int count;
};

struct SourceOptions {
  RobustLoss loss = RobustLoss::None();
  bool is_prior = false;
};

struct Source {
  std::string name;
  SourceOptions options;
  Eigen::Index rows = 0;
};

// One residual as the problem holds it.
struct Term {
  SourceId source;
  std::shared_ptr<const Residual> residual;
  std::vector<int> entries;            // indices into all entries of all blocks: the residual's x
  Eigen::VectorXd standard_deviation;  // 1 x 1 for all rows, or one each
  Eigen::Index first_row;              // within the source
};

struct SolveOptions {
  int max_iterations = 100;
  int threads = 0;         // 0: all; the result is the same for any number
  double settled = 1e-6;   // standard uncertainties
  double tolerated = 0.0;  // accepted in place of `settled` after the last iteration
  std::size_t jacobian_bytes = 200'000'000;
  // Find them all and the condition, which costs several eigensystems; else those alone that nothing determines.
  bool weak_directions = true;
};

class Problem {
 public:
  // Block and source names must be unique.
  BlockId Add(ParameterBlock block);
  // Rows are added to it afterwards.
  SourceId AddSource(std::string name, const SourceOptions& options = {});
  // Adds the rows of `residual` to `source`, with one standard deviation for all rows or one each.
  void Add(SourceId source, std::shared_ptr<const Residual> residual,
           const std::vector<Input>& inputs, double standard_deviation);
  void Add(SourceId source, std::shared_ptr<const Residual> residual,
           const std::vector<Input>& inputs, Eigen::VectorXd standard_deviations);

  // `at`, if given, receives the problem linearised at the solution (linearization.h).
  Result Solve(const SolveOptions& options = {}, Linearization* at = nullptr) const;

  // For holding, freeing and starting parameters between solves. Entries must not be added or
  // removed.
  ParameterBlock& Block(BlockId id) { return blocks_[id.index]; }
  BlockId Find(const std::string& block) const;  // InputError when there is none

  const std::vector<ParameterBlock>& blocks() const { return blocks_; }
  const std::vector<Source>& sources() const { return sources_; }
  const std::vector<Term>& terms() const { return terms_; }

 private:
  std::vector<int> EntriesOf(const std::vector<Input>& inputs) const;

  std::vector<ParameterBlock> blocks_;
  std::vector<int> first_entry_;  // of each block
  std::vector<Source> sources_;
  std::vector<Term> terms_;
};

}  // namespace abbe::estimation
