#include "fusion/holdout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "estimation/linearization.h"
#include "failure/failure.h"
#include "fusion/linkage_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using simulation::SimulatedRun;

constexpr Index kBlocksOfEach = 4;  // blocks held out of a long run

// Some rows of another residual.
class SomeRows : public estimation::Residual {
 public:
  SomeRows(std::shared_ptr<const estimation::Residual> all, std::vector<Index> rows)
      : all_(std::move(all)), rows_(std::move(rows)) {}

  Index Rows() const override { return static_cast<Index>(rows_.size()); }

  void Evaluate(const VectorXd& x, VectorXd& values,
                estimation::RowMatrix* jacobian) const override {
    VectorXd every(all_->Rows());
    estimation::RowMatrix J;
    if (jacobian != nullptr) J.resize(every.size(), x.size());
    all_->Evaluate(x, every, jacobian == nullptr ? nullptr : &J);
    values = every(rows_);
    if (jacobian != nullptr) *jacobian = J(rows_, Eigen::all);
  }

 private:
  std::shared_ptr<const estimation::Residual> all_;
  std::vector<Index> rows_;
};

SimulatedRun Part(const SimulatedRun& run, int n, bool held) {
  const Index count = run.residual->Rows();
  if (count < n) {
    throw InputError(fmt::format(
        "{}: of {} rows every {}th block cannot be held out; hold out more or leave the run away",
        run.name, count, n));
  }
  const Index block = std::max(Index{1}, count / (kBlocksOfEach * n));
  std::vector<Index> rows;
  for (Index row = 0; row < count; ++row) {
    if ((row / block % n == n - 1) == held) rows.push_back(row);
  }
  SimulatedRun part = run;
  part.residual = std::make_shared<SomeRows>(run.residual, std::move(rows));
  if (held) part.loss = estimation::RobustLoss::None();
  return part;
}

VectorXd ValuesOf(const estimation::Problem& problem, const estimation::Result& fit) {
  std::vector<double> values;
  for (const auto& block : problem.blocks()) {
    for (const auto& entry : fit.Block(block.name).entries) values.push_back(entry.value);
  }
  return Eigen::Map<VectorXd>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace

std::vector<HeldOut> HoldOut(int n, const std::vector<SimulatedRun>& runs,
                             const ProblemOf& problem_of) {
  if (n < 2) {
    throw InputError(fmt::format(
        "every {}th block of rows held out leaves nothing to fit; hold out every 2nd or fewer", n));
  }
  std::vector<SimulatedRun> kept, held;
  for (const SimulatedRun& run : runs) {
    kept.push_back(Part(run, n, false));
    held.push_back(Part(run, n, true));
  }
  const estimation::Result fit = SolveLinkage(problem_of(kept), 0, false);
  const estimation::Problem problem = problem_of(held);
  const auto at =
      estimation::Linearize(problem, estimation::Layout(problem), ValuesOf(problem, fit), 0);
  std::vector<HeldOut> result;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    HeldOut& out = result.emplace_back();
    out.name = problem.sources()[r].name;
    out.rows = problem.sources()[r].rows;
    out.chi_square = at.sources[r].chi_square;
    out.expected = static_cast<double>(out.rows) +
                   fit.covariance.cwiseProduct(at.sources[r].information).sum();
    out.rms = out.rows == 0 ? 0.0 : std::sqrt(out.chi_square / static_cast<double>(out.rows));
  }
  return result;
}

}  // namespace abbe::fusion
