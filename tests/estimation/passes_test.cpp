// The path for data that do not fit in memory must find what the other finds.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "estimation/autodiff_residual.h"
#include "estimation/linearization.h"
#include "linear_case.h"

namespace abbe::estimation {
namespace passes_test {

using Eigen::VectorXd;

// A damped wave; two blocks, many residuals.
struct Wave {
  double first;
  std::vector<double> y;
  template <class T>
  void operator()(const T* x, T* values) const {
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double t = first + 0.01 * static_cast<double>(i);
      values[i] = x[0] * exp(-x[1] * t) * sin(x[2] * t) + x[3] - y[i];
    }
  }
};

Problem WaveProblem(int residuals, const RobustLoss& loss) {
  const VectorXd truth = Eigen::Vector4d(2.0, 0.1, 3.0, 0.5);
  Problem problem;
  ParameterBlock wave = Block("wave", {"size", "decay", "rate"});
  wave["size"].value = 1.8;
  wave["decay"].value = 0.12;
  wave["rate"].value = 2.98;
  const BlockId w = problem.Add(wave), o = problem.Add(Block("offset", {"c"}, 0.4));
  const SourceId even = problem.AddSource("even", {.loss = loss}), odd = problem.AddSource("odd");
  for (int k = 0; k < residuals; ++k) {
    Wave data{0.2 * k, std::vector<double>(20, 0.0)};
    std::vector<double> exact(20);
    data(truth.data(), exact.data());
    const random::CounterRandom noise(3, std::uint64_t(k));
    for (std::size_t i = 0; i < 20; ++i) data.y[i] = exact[i] + 0.1 * noise.Normal(i);
    problem.Add(k % 2 ? odd : even, MakeAutoDiffResidual<4>(data, 20), {w, o}, 0.1);
  }
  return problem;
}

TEST(Passes, FindTheSameMinimumWithoutTheJacobian) {
  for (const RobustLoss loss : {RobustLoss::None(), RobustLoss::Huber(1.345)}) {
    const Problem problem = WaveProblem(60, loss);
    const Result with = problem.Solve(), without = problem.Solve({.jacobian_bytes = 0});
    for (const std::string& name : with.names) {
      // Both stop within 1e-6 standard uncertainties.
      EXPECT_NEAR(with.Value(name), without.Value(name), 3e-6 * with.Uncertainty(name)) << name;
      EXPECT_NEAR(with.Uncertainty(name) / without.Uncertainty(name), 1.0, 1e-5);
    }
    EXPECT_NEAR(with.chi_square, without.chi_square, 1e-4);
  }
}

TEST(Passes, AreTheSameToTheLastBitForAnyNumberOfThreads) {
  const Problem problem = WaveProblem(37, RobustLoss::Huber());
  const Layout layout(problem);
  const Linearization one = Linearize(problem, layout, layout.start, 1);
  const Linearization two = Linearize(problem, layout, layout.start, 2);
  EXPECT_EQ(one.Cost(), two.Cost());
  EXPECT_EQ(one.Gradient(), two.Gradient());
  EXPECT_EQ(one.sources[0].information, two.sources[0].information);
  const Result a = problem.Solve({.threads = 1}), b = problem.Solve({.threads = 2});
  EXPECT_EQ(a.Block("wave").Values(), b.Block("wave").Values());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Passes, LinearizationIsTheSlopeOfTheCost) {
  const Problem problem = WaveProblem(11, RobustLoss::Huber(1.0));
  const Layout layout(problem);
  const Linearization at = Linearize(problem, layout, layout.start, 0);
  const VectorXd gradient = at.Gradient();
  for (Eigen::Index i = 0; i < 4; ++i) {
    constexpr double kStep = 1e-6;
    VectorXd high = layout.start, low = layout.start;
    high[i] += kStep;
    low[i] -= kStep;
    const double slope =
        (Linearize(problem, layout, high, 0).Cost() - Linearize(problem, layout, low, 0).Cost()) /
        (2.0 * kStep);
    // Rounding of the cost over the step, and the third derivative times its square.
    EXPECT_NEAR(gradient[i], slope, 1e-5 * std::abs(gradient[i]) + 1e-4);
  }
}

TEST(Passes, VisitedRowsAddUpToTheSums) {
  const Problem problem = WaveProblem(9, RobustLoss::None());
  const Layout layout(problem);
  const Linearization at = Linearize(problem, layout, layout.start, 0);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(4, 4);
  double chi = 0.0;
  VisitRows(problem, layout, layout.start, true, [&](const WhitenedRows& rows) {
    chi += rows.r.squaredNorm();
    for (std::size_t i = 0; i < rows.columns.size(); ++i) {
      for (std::size_t j = 0; j < rows.columns.size(); ++j) {
        information(rows.columns[i], rows.columns[j]) +=
            rows.jacobian.col(Eigen::Index(i)).dot(rows.jacobian.col(Eigen::Index(j)));
      }
    }
  });
  const Eigen::MatrixXd sum = at.sources[0].information + at.sources[1].information;
  EXPECT_LT((information - sum).norm(), 1e-12 * sum.norm());
  EXPECT_NEAR(chi, at.sources[0].chi_square + at.sources[1].chi_square, 1e-12 * chi);
}

}  // namespace passes_test
}  // namespace abbe::estimation
