// A fit of runs that know their derivatives (remembering_run.h) and of causes that are taken in.
//
//   const auto minimum = MinimumByChords(problem, 0.3);     // empty: solve as usual
//
// Gauss and Newton's method with J'J of the parameters as it was summed when J was made; of the
// causes it is summed anew, which is little beside. Residuals and gradients are those of each step.
// Stops when the next step is shorter than `settled` standard uncertainties (times the scatter of
// the rows, at most ten); a step that does not lower the cost, or a point that cannot be simulated,
// is left to estimation::Problem::Solve. Units: SI; rows whitened, of no robust loss. Shapes:
// parameters as in estimation::Layout. Source: chord method, Kelley, Iterative Methods (1995), 5.4.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "estimation/linearization.h"
#include "estimation/problem.h"

namespace abbe::diagnosis {

// Normal equations at a minimum: `data` of the rows of runs alone, else with all priors.
struct FitSums {
  Eigen::MatrixXd data_information, information;
  Eigen::VectorXd data_gradient, gradient;
  Eigen::VectorXd prior;  // information of the parameters' own priors
  double cost = 0.0;
};
FitSums SumsOf(const estimation::Problem& problem, const estimation::Linearization& at);

struct ChordMinimum {
  estimation::Result result;  // blocks, names and covariance
  FitSums at;
};
std::optional<ChordMinimum> MinimumByChords(const estimation::Problem& problem, double settled);
// The sums of the derivatives that DerivativesAt gives, of the causes too: what is projected must be
// free of just these. Empty: a run does not know its derivatives.
std::optional<FitSums> KnownSumsAt(const estimation::Problem& problem, const Eigen::VectorXd& x);

// [J r] of one run; of J those of the free parameters, `columns`, that the run sees.
struct RunDerivatives {
  std::vector<int> columns;
  Eigen::MatrixXd both;
};
RunDerivatives DerivativesAt(const estimation::Problem& problem, const estimation::Layout& layout,
                             const estimation::Term& term, const Eigen::VectorXd& x);

}  // namespace abbe::diagnosis
