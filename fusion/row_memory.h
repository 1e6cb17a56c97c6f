// The noise of a run that goes on from one row to the next: an instrument that drifts, a machine that warms
// up, an encoder's wave along a path. Rows that share it tell less than independent ones.
//
//   const RowMemory found = FindRowMemory(problem, layout, x, at, run, times);
//   found.noise.slow;                    // over the stated noise, where found.gain > kRemembers
//
// With J the derivatives of the n rows at a point, and H and g the information and the gradient of
// the priors of all parameters there, the rows r of the whitened residual have
//
//   r ~ N(J H^-1 g, J H^-1 J' + V),    V: white noise and a memory (estimation/noise_memory.h)
//
// and V is where this density is highest: what parameters could follow as well, such as errors over
// an axis that moves slowly, counts for both. The white part k, over what is stated, has the weight
// of n = 20 rows that say 1; memory times of two steps to ten times the whole run, 0.15 to
// 1000 parts of slow to white. `gain`: of its logarithm, over white noise alone. Other runs have no
// part in it: a run that contradicts them does not drift for that.
// Units: s; noise in units of the stated one. Shapes: n rows in the order of their times, all
// channels of one instant together; the same noise in all channels.
// Failure: none; fewer than kFewestInstants, or times that are all the same, have no memory.
// Source: Rasmussen and Williams (2006), 2.23 and 5.4.
// Validity: first order at the point; of more than 600 instants as many, in groups of ten.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "estimation/linearization.h"
#include "estimation/noise_memory.h"
#include "estimation/problem.h"

namespace abbe::fusion {

inline constexpr Eigen::Index kFewestInstants = 30;
inline constexpr double kRemembers = 5.0;  // a gain that tells

struct RowsInTime {
  const Eigen::VectorXd& times;
  const Eigen::MatrixXd& J;
  const Eigen::VectorXd& left;
  const Eigen::MatrixXd& priors;  // H, n parameters x n
  const Eigen::VectorXd& score;   // g = J'r of the priors
};

struct RowMemory {
  estimation::NoiseMemory noise;
  double gain = 0.0;
  // Whether sums of 2, 4, ... neighbouring rows scatter as it says. A vibration, or form that is left
  // out, has small steps as a slow drift has, and is none.
  bool sums_agree = true;
  bool IsDrift() const { return gain > kRemembers && sums_agree; }
};

RowMemory FindRowMemory(const RowsInTime& rows);

// The same for the first residual of source `run` of a problem whose noise is as stated. `x`: all
// its entries; `at`: what its sources tell there, in the columns of `layout`.
RowMemory FindRowMemory(const estimation::Problem& problem, const estimation::Layout& layout,
                        const Eigen::VectorXd& x, const estimation::Linearization& at,
                        std::size_t run, const Eigen::VectorXd& times);

// The noise of a run by what was found: with a memory, which then has its white part too (`white` is
// 1), or without. False where neither changes by more than 5 % and, of the slow part, 20 %.
bool TakeUp(const RowMemory& found, double& white, std::optional<estimation::NoiseMemory>& memory);

}  // namespace abbe::fusion
