// What rounding hides in an information matrix that was summed over many rows: one measure for all
// who ask.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace abbe::estimation {

inline constexpr double kRounding = 1e-12;  // of a parameter's own information

// Whether every direction stands out of the rounding; `scaled` is the factor of the matrix with its
// diagonal scaled to 1. The reciprocal condition in the 1-norm is below that of the eigenvalues;
// the factor is for its being an estimate.
inline bool EveryDirectionStandsOut(const Eigen::LLT<Eigen::MatrixXd>& scaled) {
  return scaled.info() == Eigen::Success && scaled.rcond() > 10.0 * kRounding;
}

}  // namespace abbe::estimation
