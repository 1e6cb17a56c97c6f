// The rank of an information matrix J'J that was summed over many rows, in the presence of
// rounding.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace abbe::estimation {

inline constexpr double kRounding = 1e-12;  // relative to a parameter's own information

// Whether the matrix has full rank above rounding; `scaled` is the factor of the matrix with its
// diagonal scaled to 1. The reciprocal condition in the 1-norm is smaller than that of the
// eigenvalues; the factor 10 allows for the error of its estimate.
inline bool HasFullRank(const Eigen::LLT<Eigen::MatrixXd>& scaled) {
  return scaled.info() == Eigen::Success && scaled.rcond() > 10.0 * kRounding;
}

}  // namespace abbe::estimation
