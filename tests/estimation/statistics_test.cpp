// Over many seeds the estimates must scatter as they say they do.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "estimation/autodiff_residual.h"
#include "linear_case.h"

namespace abbe::estimation {
namespace statistics_test {

using random::CounterRandom;

constexpr int kSeeds = 200;
constexpr double kNoise = 0.02;

// Points on a circle: centre and radius free, a prior on the radius; x along, y across are both
// read.
struct OnCircle {
  std::vector<double> angle, x, y;
  template <class T>
  void operator()(const T* p, T* values) const {
    using std::cos, std::sin;
    for (std::size_t i = 0; i < angle.size(); ++i) {
      values[2 * i] = p[0] + p[2] * cos(angle[i] + p[3]) - x[i];
      values[2 * i + 1] = p[1] + p[2] * sin(angle[i] + p[3]) - y[i];
    }
  }
};

struct World {
  Eigen::Vector4d truth;
  Result result;
};

World Draw(int seed) {
  const CounterRandom world(static_cast<std::uint64_t>(seed), 0),
      noise(static_cast<std::uint64_t>(seed), 1);
  constexpr double kPrior = 0.01;
  const Eigen::Vector4d truth(world.Normal(0), world.Normal(1), 1.0 + kPrior * world.Normal(2),
                              0.1 * world.Normal(3));
  OnCircle data;
  for (int i = 0; i < 12; ++i) data.angle.push_back(0.13 * i);
  std::vector<double> exact(24);
  data.x.assign(12, 0.0);
  data.y.assign(12, 0.0);
  data(truth.data(), exact.data());
  for (std::size_t i = 0; i < 12; ++i) {
    data.x[i] = exact[2 * i] + kNoise * noise.Normal(2 * i);
    data.y[i] = exact[2 * i + 1] + kNoise * noise.Normal(2 * i + 1);
  }
  Problem problem;
  const BlockId circle =
      problem.Add({"circle", {}, {{"x"}, {"y"}, {"radius", 1.0, kPrior}, {"phase", 0.0, 0.1}}});
  problem.Add(problem.AddSource("points"), MakeAutoDiffResidual<4>(data, 24), {circle}, kNoise);
  return {truth, problem.Solve()};
}

TEST(Statistics, PullsHaveUnitVarianceAndCoverageIsNinetyFivePerCent) {
  double square[4] = {}, mean[4] = {}, chi = 0.0, redundancy = 0.0;
  int covered = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const World world = Draw(seed);
    ASSERT_TRUE(world.result.Usable());
    for (std::size_t i = 0; i < 4; ++i) {
      const Parameter& entry = world.result.blocks[0].entries[i];
      const double pull = (entry.value - world.truth[Eigen::Index(i)]) / entry.uncertainty;
      mean[i] += pull / kSeeds;
      square[i] += pull * pull;
      // One parameter per seed: those of one seed are correlated.
      if (static_cast<std::size_t>(seed) % 4 == i) covered += std::abs(pull) < 1.959964 ? 1 : 0;
    }
    chi += world.result.Source("points").chi_square;
    redundancy += world.result.Source("points").redundancy;
  }
  for (int i = 0; i < 4; ++i) {
    // 99 % bands: normal for the mean, chi-square of 200 for the sum of squares (152.2 to 255.3).
    EXPECT_NEAR(mean[i], 0.0, 2.576 / std::sqrt(double(kSeeds))) << i;
    EXPECT_GT(square[i], 152.2) << i;
    EXPECT_LT(square[i], 255.3) << i;
  }
  // 99 % of the binomial(200, 0.95): 181 to 197.
  EXPECT_GE(covered, 181);
  EXPECT_LE(covered, 197);
  // The sum of the chi-squares has about `redundancy` degrees of freedom in all.
  EXPECT_NEAR(chi / redundancy, 1.0, 2.576 * std::sqrt(2.0 / redundancy));
}

TEST(Statistics, AWrongNoiseStatementShowsInThePulls) {
  // The band must be able to fail: pulls of a noise stated 30 % too small.
  double square = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const CounterRandom noise(static_cast<std::uint64_t>(seed), 5);
    Problem problem;
    const BlockId p = problem.Add(Block("p", {"x"}));
    Eigen::VectorXd y(10);
    for (int i = 0; i < 10; ++i) y[i] = noise.Normal(std::uint64_t(i));
    problem.Add(problem.AddSource("s"), Linear(Eigen::MatrixXd::Ones(10, 1), y), {p}, 0.7);
    const Result result = problem.Solve();
    square += std::pow(result.Value("p.x") / result.Uncertainty("p.x"), 2);
  }
  EXPECT_GT(square, 255.3);
}

}  // namespace statistics_test
}  // namespace abbe::estimation
