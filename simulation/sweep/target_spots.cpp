#include "simulation/sweep/target_spots.h"

#include <cmath>

#include "simulation/sweep/sweep_reading.h"

namespace abbe::simulation {

using Eigen::Index;

Eigen::MatrixXd SpotsOnTarget(const machine::Chain& chain, const probes::HeadSettings& head,
                              const SweepRun& run) {
  const double along_axis = head.Frame(run.axis).R_MH.col(0)[machine::AxisIndex(run.axis)];
  const double way = chain.ToolSense(run.axis) * along_axis;
  const double turned = run.mounted.head_turned ? -1.0 : 1.0;
  const double middle = 0.5 * way * (run.position.minCoeff() + run.position.maxCoeff());
  Eigen::MatrixXd spots(2 * kProbes, run.rows());
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const Eigen::Vector2d place = PlaceOf(head.layout, probe);
    const double across = OnTop(probe) ? turned * place[1] : place[1];
    const Eigen::Index row = 2 * probe;
    spots.row(row) = (way * run.position.array() + turned * place[0] - run.mounted.target_shift)
                         .matrix()
                         .transpose();
    spots.row(row + 1).setConstant(across);
    if (!run.mounted.target_reversed) continue;
    spots.row(row) = 2.0 * middle - spots.row(row).array();
    spots.row(row + 1) *= -1.0;
  }
  return spots;
}

double FormCorrelation(double square, double length) {
  constexpr double kNothing = 80.0;  // lengths squared
  const double apart = square / (length * length);
  return apart < kNothing ? std::exp(-0.5 * apart) : 0.0;
}

}  // namespace abbe::simulation
