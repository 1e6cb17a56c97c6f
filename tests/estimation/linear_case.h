// Linear problems with random, known matrices: closed forms are at hand.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include "estimation/problem.h"
#include "random/counter_random.h"

namespace abbe::estimation {

inline Eigen::MatrixXd RandomMatrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Eigen::MatrixXd a(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    const random::CounterRandom numbers(seed, static_cast<std::uint64_t>(j));
    for (Eigen::Index i = 0; i < rows; ++i) a(i, j) = numbers.Normal(static_cast<std::uint64_t>(i));
  }
  return a;
}

inline ParameterBlock Block(const std::string& name, const std::vector<std::string>& entries,
                            double prior_sd = kNoPrior) {
  ParameterBlock block{name, {"um", 1e-6}, {}};
  for (const std::string& entry : entries) block.entries.push_back({entry, 0.0, prior_sd});
  return block;
}

inline std::shared_ptr<const Residual> Linear(Eigen::MatrixXd a, Eigen::VectorXd b) {
  return std::make_shared<LinearResidual>(std::move(a), std::move(b));
}

}  // namespace abbe::estimation
