// What an arm does beside its geometry and noise: turns of its joints that are smooth in the
// posture, such as by weight, gears or eccentricity, and a place that moves slowly. The geometry
// takes part of it for its own, coherently in all poses, so no larger noise contains that.
//
//   const Discrepancy something = DiscrepancyOf(runs, prior_sd, off, covariance, 1.0);
//   covariance += something.covariance;
//
// Beside the noise there is a Gaussian random field: each joint turns by a field over its own angle
// and by one over those of all joints, of two lengths each, and by chance in each pose; the ball
// moves by a field over the time of the run. The distance between two angles is the chord of the
// unit circle. How large each field is, is what makes the residuals most probable, the parameters
// with their priors unknown (estimation/variance_parts.h). Where noise alone explains them as well,
// nothing is added: the field counts with its probability,
//
//   odds = kElse exp(gain in log likelihood - kByChance).
//
// The estimates stay; what a field of the covariance K does to them is C J' K J C.
// Frames: B for displacements of the ball.
// Units: rows whitened; rad, s. Shapes: as ArmLeft says; covariance free x free parameters.
// Failure: that of EstimateVariances.
// Source: Kennedy, O'Hagan, Bayesian calibration of computer models, J. R. Stat. Soc. B 63 (2001),
// 425; kinds and lengths of the fields: own choice.
// Validity: first order; estimated from kMostPoses poses, with kMostCounted counted. What no pose
// shows, because the geometry can do all of it, has the size of what is like it and shows.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::fusion {

// What a run leaves, and what its rows are moved by: three rows for each pose.
struct ArmLeft {
  Eigen::MatrixXd angles;         // pivots x poses
  Eigen::VectorXd time;           // of each pose; all alike: of no known order
  Eigen::VectorXd left;           // at the estimates
  Eigen::MatrixXd by_parameters;  // rows x free parameters
  Eigen::MatrixXd by_stage;       // rows x pivots + 3: turns of the pivots, then of the ball
};

struct Discrepancy {
  double probability = 0.0;
  Eigen::MatrixXd covariance;  // to be added to that of the estimates
};

// `off`: estimates less their nominal values; `least`: the stated variance, of the rows as they are
// whitened.
Discrepancy DiscrepancyOf(const std::vector<ArmLeft>& runs, const Eigen::VectorXd& prior_sd,
                          const Eigen::VectorXd& off, const Eigen::MatrixXd& covariance,
                          double least);

}  // namespace abbe::fusion
