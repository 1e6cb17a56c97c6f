// Large products, which Eigen leaves to OpenBLAS, made in several threads at once.
#include <gtest/gtest.h>

#include <cstddef>
#include <thread>
#include <vector>

#include "linear_case.h"

namespace abbe::estimation {
namespace products_test {

constexpr int kRounds = 2000;

// One pair of factors a thread, of a size of its own.
struct Factors {
  Eigen::MatrixXd a, b;

  // As sums of rows and solutions make them.
  Eigen::MatrixXd Product() const {
    Eigen::MatrixXd square = Eigen::MatrixXd::Identity(a.cols(), a.cols());
    square.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
    return square.selfadjointView<Eigen::Lower>().llt().solve(b * a.transpose());
  }
};

std::vector<Factors> FactorsOfThreads() {
  std::vector<Factors> factors;
  for (std::uint64_t thread = 0; thread < 4; ++thread) {
    const auto size = static_cast<Eigen::Index>(60 + 8 * thread);
    factors.push_back(
        {RandomMatrix(size, size, 2 * thread + 1), RandomMatrix(size, size, 2 * thread + 2)});
  }
  return factors;
}

TEST(Products, OfSeveralThreadsAreThoseOfOneToTheLastBit) {
  const std::vector<Factors> factors = FactorsOfThreads();
  std::vector<Eigen::MatrixXd> alone;
  for (const Factors& each : factors) alone.emplace_back(each.Product());
  std::vector<int> wrong(factors.size(), 0);
  std::vector<std::jthread> threads;
  for (std::size_t t = 0; t < factors.size(); ++t) {
    threads.emplace_back([&, t] {
      for (int round = 0; round < kRounds; ++round) {
        if (factors[t].Product() != alone[t]) ++wrong[t];
      }
    });
  }
  threads.clear();  // joins
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    EXPECT_EQ(wrong[t], 0) << "of " << kRounds << " in thread " << t;
  }
}

}  // namespace products_test
}  // namespace abbe::estimation
