// Group means of readings under a slow drift (first-order Markov noise).
//
//   y_k = m_g(k) + d(t_k) + e_k
//   e_k ~ N(0, w_k), white
//   cov(d(t), d(t')) = s^2 exp(-|t - t'| / tau)      stationary (Ornstein-Uhlenbeck)
//
// y_k is read at time t_k in group g(k): a station of a sweep, which several passes visit. The
// group values m have no prior, the drift has the one above. Generalised least squares gives m and
// its full covariance, in which readings close in time are correlated:
//
//   const auto fit = FitGroupsUnderDrift(times, stations, readings, white, 0.2e-6, 600.0, 61);
//   fit.values.col(0);  fit.covariance;  fit.chi_square[0] / fit.freedom;  // should be near 1
//
// Background: the precision of d is tridiagonal, so d is eliminated at a cost of O(K) for each
// group and V^-1 = (W + s^2 R)^-1 is never formed. C columns with the same times, groups and
// variances (several probes read together) need one factorisation. Only the prior of the drift
// separates a constant common to all groups from a drift that does not return: when the readings
// last much less than tau, the standard deviation of the mean of m tends to s. Differences between
// groups are not affected. Shapes: K readings, G groups, C columns; values K x C.
// Units: values and drift_sd in one unit, white_variances in its square; times and drift_time in s.
// Failure: InputError for lists of different length, times that do not increase, a group without
// readings or outside 0 .. G-1, a variance not above 0, drift_sd < 0, drift_time <= 0 where
// drift_sd > 0, values that are not finite. NumericalError when the drift hides the group values.
// Source: Rasmussen and Williams, Gaussian Processes (2006), 2.7 (explicit basis, vague prior) and
// B.2 (Ornstein-Uhlenbeck).
// Validity: w, s and tau are known; to estimate them, maximise log_restricted_likelihood. K up to
// 10^5 and G up to 250 take about a second.
#pragma once

#include <Eigen/Core>
#include <span>

namespace abbe::estimation {

struct MarkovNoiseFit {
  Eigen::MatrixXd values;      // G x C: the group values m
  Eigen::MatrixXd covariance;  // G x G, of each column of `values`
  Eigen::MatrixXd drift;       // K x C: the expected d(t_k)
  Eigen::MatrixXd residuals;   // K x C: y - m - d
  // C x 1: (y - m)' V^-1 (y - m), expected K - G when the variances are right.
  Eigen::VectorXd chi_square;
  // C x 1: log of the density of the data, the group values marginalised (REML).
  Eigen::VectorXd log_restricted_likelihood;
  Eigen::Index freedom = 0;  // K - G
};

// `groups`: of each reading, 0 .. G-1; `drift_sd` 0: white noise alone.
MarkovNoiseFit FitGroupsUnderDrift(std::span<const double> times, std::span<const int> groups,
                                   const Eigen::MatrixXd& values,
                                   std::span<const double> white_variances, double drift_sd,
                                   double drift_time, int group_count);

}  // namespace abbe::estimation
