// The mean of a sample that may hold a few wrong values, with its standard error.
//
// Huber's M-estimate of location: the m with
//
//   sum_i psi((x_i - m) / (s sigma_i)) / sigma_i = 0,   psi(t) = max(-k, min(k, t))
//
// started at the median, s from the median absolute deviation (MAD), solved by iteratively
// reweighted means. A value within k scales of the mean counts in full, one further away counts as
// if it stood k scales away: no value, however wrong, pulls with more than that.
//
//   const RobustMean dwell = HuberMean(readings);
//   dwell.mean, dwell.standard_error;      // and dwell.outliers of dwell.count look wrong
//
// Tuning: k = 2.0 has the variance of the plain mean times 1.010 at normal data (efficiency 99.0 %;
// a median has 64 %); with a share e of wrong values, all on one side and as far as they like, the
// bias is at most e k / ((1 - e)(2 Phi(k) - 1)) = 0.23 scales for e = 10 %. k = 1.345 has 95 % and
// 0.18 scales.
// Units: those of the values. Shapes: values and deviations of equal length n.
// Failure: NumericalError for an empty sample, a value that is not finite, a deviation not above 0.
// Source: Huber, Annals of Mathematical Statistics 35 (1964); standard error: Huber and Ronchetti,
// Robust Statistics, eq. 6.5 with n/(n-1); small-sample factors of the MAD: Croux and Rousseeuw,
// COMPSTAT 1992. Validity: independent values; below 4 values it is the plain (weighted) mean,
// since two or three values do not say which of them is wrong. Drift: see markov_noise.h.
#pragma once

#include <cstddef>
#include <span>

namespace abbe::estimation {

struct RobustMean {
  double mean = 0.0;
  // Of the mean; infinite for one value whose deviation nobody stated.
  double standard_error = 0.0;
  // Of one value (of sigma_i = 1 where deviations are given), without what outliers do to it.
  double scale = 0.0;
  std::size_t count = 0;
  std::size_t down_weighted = 0;  // beyond k scales
  std::size_t outliers = 0;       // beyond `outlier_at` scales
};

struct RobustMeanOptions {
  double tuning = 2.0;      // k
  double outlier_at = 4.0;  // scales; beyond it a value is counted as an outlier
  // Where the noise is known better than this sample tells (pooled over stations): the scale of one
  // value. 0: from the sample.
  double known_scale = 0.0;
};

RobustMean HuberMean(std::span<const double> values, const RobustMeanOptions& options = {});

// Values of unequal standard deviation sigma_i, known up to the common factor `scale` (known_scale
// 1 takes them as they are).
RobustMean HuberMean(std::span<const double> values, std::span<const double> deviations,
                     const RobustMeanOptions& options = {});

// The median absolute deviation about the median, made consistent with the standard deviation of
// normal data, sample size included. When more than half of the values are equal (a coarse digital
// reading) a higher quantile takes the place of the median deviation. 0 for constant data.
double RobustScale(std::span<const double> values);

}  // namespace abbe::estimation
