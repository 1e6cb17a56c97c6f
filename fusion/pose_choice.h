// Which poses to measure, and how many are enough.
//
//   const PoseInformation candidates(simulation, run, x);
//   const PoseChoice choice = ChoosePoses(candidates, 40);
//   choice.poses;                       // indices into the run
//   for (const EnoughRow& row : HowManyPoses(candidates, {10, 20, 40, 80})) {
//     fmt::print("{}\n", row.poses);
//   }
//
// Background: pose i brings the information J_i' J_i (J_i: 3 x parameters, whitened). The choice of
// N poses that makes det(P^-1 + sum J_i' J_i) largest makes the volume of the uncertainty smallest
// (D-optimal, with the priors P). Poses are added one by one, the best first; then chosen and other
// poses are exchanged while the determinant grows. The figure of merit for the user is the
// uncertainty of ball positions over all candidates, `tip_rms`. Poses are enough when the
// calibration adds less than a tenth to the noise of a single reading.
//
// Units: m. Shapes: one entry of J per pose.
// Failure: InputError when more poses are asked for than there are candidates.
// Source: Fedorov, "Theory of Optimal Experiments" (1972), the exchange; Borm and Menq,
// "Determination of optimal measurement configurations for robot calibration" (1991).
// Validity: to first order at x; a local optimum of the exchange.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {

struct PoseInformation {
  // `x`: parameters of the simulation. Parameters without a prior get one of 1 (m, rad).
  PoseInformation(const simulation::LinkageSimulation& simulation,
                  const simulation::LinkageRun& run, const Eigen::VectorXd& x);

  Eigen::Index poses() const { return white.rows() / 3; }

  Eigen::MatrixXd white;  // 3 poses x free parameters in units of their priors, whitened
  Eigen::MatrixXd tip;    // the same, not whitened: m
  double reading_noise;   // m: rms 3D noise of a single reading by the encoders
};

struct PoseChoice {
  std::vector<Eigen::Index> poses;
  double log_determinant;
  double tip_rms;  // m: 3D uncertainty of ball positions from the calibration, over all candidates
  int exchanges;
};
// `count` of the candidates, each at most once.
PoseChoice ChoosePoses(const PoseInformation& candidates, Eigen::Index count);

// m: 3D standard uncertainty of a ball position by a calibration with `poses`, rms over all
// candidates.
double TipUncertainty(const PoseInformation& candidates, const std::vector<Eigen::Index>& poses);

struct EnoughRow {
  Eigen::Index poses;
  double tip_rms;   // m, chosen by ChoosePoses
  double even_rms;  // m, as many poses taken evenly from the candidates
  bool enough;
};
// One row a count.
std::vector<EnoughRow> HowManyPoses(const PoseInformation& candidates,
                                    const std::vector<Eigen::Index>& counts);

}  // namespace abbe::fusion
