// The gaps of a run of the linkage as a residual: where the linkage finds the ball less where the
// reference does.
//
//   const LinkageGaps gaps(simulation, run);
//   gaps.InSpace(left);                               // m, of whitened rows
//
// Rows: x, y, z of pose 0, then of pose 1, ..., in M, made white with GapNoise, so they have the
// standard deviation 1. x: that of LinkageSimulation. Disturbances act at the stages tip and
// encoder (simulation/disturbance.h): no machine is between.
// Frames: M.
// Units: m, rad. Shapes: values 3 poses x 1; the Jacobian with LinkageSimulation::parameters()
// columns.
// Failure: InputError of GapNoise.
// Source: linkage_simulation.h, the gap.
// Validity: the reference is right to its stated deviation.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "simulation/linkage/linkage_simulation.h"
#include "simulation/simulated_run.h"

namespace abbe::simulation {

class LinkageGaps : public Responsive {
 public:
  // `excess`: how many times larger than stated the noise is.
  LinkageGaps(LinkageSimulation simulation, LinkageRun run, double excess = 1.0);

  // Made white with the mean of GapNoise over the poses, the same for all: what goes on from pose to
  // pose in space then does so in the rows.
  static LinkageGaps Evenly(const LinkageSimulation& simulation, const LinkageRun& run);

  // Three a pose.
  Eigen::Index Rows() const override { return 3 * run_.poses(); }
  // Whitened.
  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& values,
                estimation::RowMatrix* jacobian) const override;
  // At the stages tip and encoder.
  std::shared_ptr<const Response> At(const Eigen::VectorXd& x) const override;

  // What whitened rows are in space, one column for each pose.
  Eigen::Matrix3Xd InSpace(const Eigen::VectorXd& rows) const;

 private:
  auto Noise(Eigen::Index pose) const {
    return noise_.middleCols<3>(3 * pose).triangularView<Eigen::Lower>();
  }

  LinkageSimulation simulation_;
  LinkageRun run_;
  Eigen::Matrix3Xd noise_;
};

}  // namespace abbe::simulation
