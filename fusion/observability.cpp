#include "fusion/observability.h"

#include <Eigen/Dense>
#include <cmath>

#include "estimation/linearization.h"
#include "fusion/machine_problem.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The information about the parameters with a prior, in units of the prior, the others eliminated.
MatrixXd InUnitsOfPrior(const MatrixXd& data, const VectorXd& prior_sd) {
  std::vector<Index> known, open;
  for (Index i = 0; i < prior_sd.size(); ++i) {
    (std::isfinite(prior_sd[i]) ? known : open).push_back(i);
  }
  MatrixXd information = data(known, known);
  if (!open.empty()) {
    const MatrixXd cross = data(open, known);
    information -= cross.transpose() *
                   MatrixXd(data(open, open)).completeOrthogonalDecomposition().solve(cross);
  }
  const VectorXd scale = prior_sd(known);
  return scale.asDiagonal() * information * scale.asDiagonal();
}

}  // namespace

Observability Observe(const estimation::Problem& problem, const estimation::Result& result) {
  const estimation::Layout layout(problem);
  const auto at = estimation::Linearize(problem, layout, ValuesFound(result, result.blocks), 1);
  MatrixXd data = MatrixXd::Zero(layout.columns(), layout.columns());
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    if (!problem.sources()[s].options.is_prior) data += at.sources[s].information;
  }
  const MatrixXd information = InUnitsOfPrior(data, layout.prior_sd);
  Observability seen;
  seen.parameters = layout.columns();
  if (information.size() > 0) {  // with all tolerances at 0 no parameter has a prior
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information, Eigen::EigenvaluesOnly);
    seen.singular_values = eigen.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt();
  }
  seen.unseen = result.weak_directions;
  seen.rank = seen.parameters - seen.unseen.size();
  seen.condition = result.condition;
  const Index known = (seen.singular_values.array() >= 1.0).count();
  if (known > 0) {
    const double smallest = seen.singular_values[known - 1];
    seen.noise_amplification = smallest * smallest / seen.singular_values[0];
  }
  return seen;
}

}  // namespace abbe::fusion
