// Noise of which a part goes on from one reading to the next: white noise and a short memory.
//
//   y_k = d(t_k) + e_k,   e_k ~ N(0, white^2),   cov(d(t), d(t')) = slow^2 exp(-|t - t'| / time)
//
//   const MemoryFit found = FitMemory(stays);             // of readings about an unknown mean each
//   const MemoryFilter filter(times, found.noise);
//   filter.Whiten(columns);                               // rows in the order of `times`
//
// The filter is that of Kalman for the scalar d: W y are the innovations over their deviations, so
// W V W' = 1 with V the covariance of y, W lower triangular and never formed: O(K) for each column.
// Units: those of the readings, s. Shapes: K times, columns K x C. Times do not decrease.
// Failure: none; FitMemory of fewer than eight readings finds white noise.
// Source: Rasmussen and Williams, Gaussian Processes (2006), B.2; Kalman, J. Basic Engineering 82
// (1960).
// Validity: FitMemory tries times of 1 to 60 steps between readings; a drift that is slower counts
// as one of 60, and a line in time is none of these (readings_at_rest.h tells them apart).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace abbe::estimation {

struct NoiseMemory {
  double white = 1.0, slow = 0.0;  // standard deviations
  double time = 1.0;               // s

  double sd() const;  // of one reading
  // White readings, as a share of these, of which the mean square is known as well.
  double Independent(double step) const;
};

class MemoryFilter {
 public:
  MemoryFilter(const Eigen::VectorXd& times, const NoiseMemory& noise);

  void Whiten(Eigen::Ref<Eigen::MatrixXd> columns) const;            // W y
  void Restore(Eigen::Ref<Eigen::MatrixXd> columns) const;           // W^-1 y
  void WhitenTransposed(Eigen::Ref<Eigen::MatrixXd> columns) const;  // W' y
  double log_determinant() const;                                    // of V
  Eigen::VectorXd Weights() const;                                   // K: the diagonal of V^-1

 private:
  Eigen::VectorXd sd_, gain_;  // of the innovations; what of one the memory takes up
  Eigen::VectorXd kept_;       // of the memory until the next reading
};

// The deviation of what readings do not remember, by the median of their second differences: what goes
// on from one to the next, and few that are far off, have little part in it. 0 for fewer than three.
double WhitePart(const std::vector<Eigen::VectorXd>& channels);

// Readings of one channel while nothing moves, about a mean of their own.
struct Stay {
  Eigen::VectorXd time, value;
};

struct MemoryFit {
  NoiseMemory noise;
  double gain = 0.0;  // logarithm of the likelihood over that of white noise
  double step = 0.0;  // s, between readings: the median
};
// The most probable memory of the stays together.
MemoryFit FitMemory(const std::vector<Stay>& stays);

}  // namespace abbe::estimation
