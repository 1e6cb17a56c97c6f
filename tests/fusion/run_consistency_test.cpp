// Consistency of the runs: the statistic does not depend on how far an iteration came; which run is
// wrong is what leaving it out says.
#include "fusion/run_consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include "estimation/linearization.h"
#include "estimation/problem.h"
#include "estimation/residual.h"

namespace abbe::fusion {
namespace run_consistency_test {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// Two lengths, read twice to 1 m and once to 1e-5 m, which reads 2.5 m more.
class TwoRuns : public testing::Test {
 protected:
  TwoRuns() {
    const auto input =
        problem_.Add({"length", {"m", 1.0}, {{"a", 1.0, 1e6, 0.0}, {"b", 1.0, 1e6, 0.0}}});
    const std::vector<estimation::Input> inputs{input};
    const auto read = [](double at) {
      return std::make_shared<estimation::LinearResidual>(MatrixXd::Identity(2, 2),
                                                          Vector2d::Constant(at));
    };
    problem_.Add(problem_.AddSource("rough"), read(1.0), inputs, 1.0);
    problem_.Add(problem_.AddSource("also rough"), read(1.0), inputs, 1.0);
    problem_.Add(problem_.AddSource("fine"), read(1.0 + 2.5), inputs, kFine);
  }

  // The check of the fine run, linearised so far from the solution.
  RunConsistency Fine(double off) const {
    const estimation::Layout layout(problem_);
    const double rough = 2.0, fine = 1.0 / (kFine * kFine);
    const double solution = (rough * 1.0 + fine * 3.5) / (rough + fine);
    const VectorXd x = Vector2d(solution + off, solution - off);
    return CheckRuns(problem_, estimation::Linearize(problem_, layout, x, 1)).at(2);
  }

  static constexpr double kFine = 1e-5;
  estimation::Problem problem_;
};

TEST_F(TwoRuns, DisagreeByWhatTheyDo) {
  // The others know 1 +- 1 / sqrt 2.
  const RunConsistency fine = Fine(0.0);
  EXPECT_EQ(fine.directions, 2);
  EXPECT_NEAR(fine.statistic, 2.0 * 2.5 * 2.5 / 0.5, 1e-3);
}

TEST_F(TwoRuns, DisagreeByThatWhereAnIterationStoppedToo) {
  for (const double off : {0.01, 1.0, 100.0}) {
    EXPECT_NEAR(Fine(off * kFine).statistic, Fine(0.0).statistic, 1e-3) << off;
  }
}

// Runs that each read one length to 1 m.
std::vector<int> MayBeWrongOf(const std::vector<double>& readings) {
  estimation::Problem problem;
  const auto input = problem.Add({"length", {"m", 1.0}, {{"a", 0.0, 1e6, 0.0}}});
  for (const double reading : readings) {
    problem.Add(problem.AddSource(std::to_string(problem.sources().size())),
                std::make_shared<estimation::LinearResidual>(MatrixXd::Identity(1, 1),
                                                             VectorXd::Constant(1, reading)),
                {input}, 1.0);
  }
  const estimation::Layout layout(problem);
  return MayBeWrong(problem, estimation::Linearize(problem, layout, layout.start, 1));
}

TEST(MayBeWrong, IsTheOneThatTwoOthersDisagreeWith) {
  EXPECT_EQ(MayBeWrongOf({0.0, 10.0, 0.3}), std::vector<int>{1});
}

TEST(MayBeWrong, IsEitherOfTwo) { EXPECT_EQ(MayBeWrongOf({0.0, 10.0}), (std::vector<int>{0, 1})); }

TEST(MayBeWrong, IsNoneOfThreeThatAllDisagree) {
  EXPECT_TRUE(MayBeWrongOf({0.0, 10.0, 20.0}).empty());
}

TEST(MayBeWrong, IsAnyWhereAllAgree) {
  EXPECT_EQ(MayBeWrongOf({0.0, 0.3, -0.2}), (std::vector<int>{0, 1, 2}));
}

}  // namespace run_consistency_test
}  // namespace abbe::fusion
