#include "fusion/holdout.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "estimation/chosen_rows.h"
#include "estimation/linearization.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "simulation/linkage/linkage_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using simulation::SimulatedRun;

constexpr Index kBlocksOfEach = 4;  // blocks held out of a long run

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
  part.residual = std::make_shared<estimation::ChosenRows>(run.residual, std::move(rows));
  if (held) part.loss = estimation::RobustLoss::None();
  return part;
}

// r' (1 + J C J')^-1 r, of H = J'J and g = J'r (Woodbury).
double Predicted(const estimation::SourceSums& held, const Eigen::MatrixXd& C) {
  Eigen::MatrixXd known = C * held.information;
  known.diagonal().array() += 1.0;
  return held.chi_square - held.gradient.dot(known.partialPivLu().solve(C * held.gradient));
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
  const estimation::Result fit = simulation::SolveLinkage(problem_of(kept), 0, false);
  const estimation::Problem problem = problem_of(held);
  const auto at = estimation::Linearize(problem, estimation::Layout(problem),
                                        ValuesFound(fit, problem.blocks()), 0);
  std::vector<HeldOut> result;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    HeldOut& out = result.emplace_back();
    out.name = problem.sources()[r].name;
    out.rows = problem.sources()[r].rows;
    out.chi_square = Predicted(at.sources[r], fit.covariance);
    out.expected = static_cast<double>(out.rows);
    out.rms = out.rows == 0 ? 0.0 : std::sqrt(at.sources[r].chi_square / out.rows);
  }
  return result;
}

}  // namespace abbe::fusion
