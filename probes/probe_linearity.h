// What a probe departs from its straight characteristic over the gap.
//
// A departure is a smooth function of the gap that nobody knows: a Gaussian process over the gaps g
// with head.tolerance.linearity as standard deviation s,
//
//   cov(e(g), e(h)) = s^2 exp(-(g - h)^2 / (2 l^2)),     l = kLinearityLength of the range
//
// which is as bent as a wave of 2.5 periods over the range. A sweep whose gaps stay within l sees
// little of it, one over a tilted target much.
// Frames: none. Units: m. Shapes: one gap a row, gaps x gaps out.
// Failure: none. Source: own; Rasmussen and Williams, Gaussian Processes (2006), eq. 2.31.
// Validity: departures of different probes are independent; those of a characteristic that is less
// smooth than a wave of four periods over the range are larger for near gaps.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace abbe::probes {

inline constexpr double kLinearityLength = 1.0 / 16.0;  // of the range of a probe
// The departure of a good probe, relative to its range: a limit of 0.1 %, evenly likely within.
inline constexpr double kUsualLinearity = 0.001 / 1.7320508;

// The covariance of readings at these gaps; `linearity`: standard deviation.
inline Eigen::MatrixXd LinearityCovariance(const Eigen::VectorXd& gaps, double linearity,
                                           double range) {
  const double length = kLinearityLength * range;
  Eigen::MatrixXd V(gaps.size(), gaps.size());
  for (Eigen::Index h = 0; h < gaps.size(); ++h) {
    V.col(h) = linearity * linearity *
               (-0.5 * ((gaps.array() - gaps[h]) / length).square()).exp().matrix();
  }
  return V;
}

}  // namespace abbe::probes
