// What one pass shows of drift: forward and backward visit a station at two times, and differ by
// its reversal and by what the probe has drifted between.
//
// Where the differences of a probe are beyond its noise model (chi-square at 99 % over all five
// probes, a constant difference left free), it is taken to drift as a Gaussian process beside that
// model, with covariance
//
//   S^2 k(|t - t'| / tau),   k = exp(-x), (1 + sqrt(3) x) exp(-sqrt(3) x), exp(-x^2 / 2)
//
// The three forms (rough to smooth), S and tau are averaged over, weighted by the restricted
// likelihood of the differences. Before the data all forms and all log(tau) are alike, and S is
// half-Cauchy with the root mean square of the differences as its scale.
//
// The part of a drift that is odd about the turn of the sweep is in the differences; the even part
// is in the mean of both directions and in no difference. A stationary process has both alike and
// independent, so the means stay as they are, and their covariance is what the odd part says.
//
// Units: s; those of the gaps. Shapes: groups, numbered station * 2 + k; one time for each.
// Failure: none.
// Source: Rasmussen and Williams, Gaussian Processes (2006), 2.7 (vague constant), 4.2 (forms); the
// average over them is own, a sum over a grid.
// Validity: a drift that is alike before and after the turn; one that is even about it is unseen.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "probes/station_means.h"

namespace abbe::probes {

struct OnePassDrift {
  Eigen::MatrixXd covariance;  // groups x groups, to be added to that of the noise
  double times;                // rms of the differences over what the noise model says
  Eigen::Index station;        // where they are largest
};

// Nothing where the differences agree with the covariance `noise` of the `gap`.
std::optional<OnePassDrift> DriftOfOnePass(const Eigen::VectorXd& time, const Eigen::VectorXd& gap,
                                           const Eigen::MatrixXd& noise);

// Enlarges the covariances of a sweep whose noise nothing checks: by UncheckedTimes(kKnownTo), and
// by the drifts of its one pass, with a note. `axis` is the swept one.
void CountUncheckedNoise(char axis, StationMeans& means);

}  // namespace abbe::probes
