// A run that keeps its derivatives as long as they hold.
//
//   run = Remembering(run);
//
// A diagnosis fits the same runs dozens of times, a few standard deviations apart, and derivatives
// cost many times what values do. Values are always those at x. Derivatives, by parameters and of
// disturbances, are those of an earlier x0 as long as the values are what these predict,
//
//   |r(x) - r(x0) - J(x0) (x - x0)| < 0.03         whitened, all rows together
//
// Threads: any. Failure: that of the residual. Validity: J is then off by about 0.03 of what the
// step is long in standard deviations, which moves a minimum by less than that share of one.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "simulation/simulated_run.h"

namespace abbe::diagnosis {

// A residual that keeps them.
class KnownRows : public simulation::Responsive {
 public:
  struct Derivatives {
    Eigen::MatrixXd jacobian, square;  // J, J'J
  };
  // Those that hold at x.
  virtual std::shared_ptr<const Derivatives> KnownAt(const Eigen::VectorXd& x) const = 0;
};

simulation::SimulatedRun Remembering(simulation::SimulatedRun run);

}  // namespace abbe::diagnosis
