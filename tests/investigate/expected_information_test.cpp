// Laws of the expected information.
#include "investigate/expected_information.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/causes/cause.h"

namespace abbe {
namespace expected_information_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using investigate::World;

const simulation::Cause& OneCoefficient() {
  static const simulation::Cause cause = [] {
    simulation::Cause made;
    made.id = "shift";
    made.plausible = VectorXd::Ones(1);
    return made;
  }();
  return cause;
}

World Nothing(double probability) {
  return {investigate::kNothing, investigate::kNothing, probability};
}

// A cause whose size is unknown.
World Cause(const char* name, double probability) {
  World world{name, name, probability};
  world.candidate = std::make_shared<const diagnosis::Candidate>(
      diagnosis::Candidate{&OneCoefficient(), name, {}});
  world.mean = VectorXd::Zero(1);
  world.deviation = VectorXd::Ones(1);
  return world;
}

double Bits(std::initializer_list<double> probabilities) {
  double bits = 0.0;
  for (const double each : probabilities) bits -= each * std::log2(each);
  return bits;
}

// A run that shows nothing tells nothing.
TEST(ExpectedInformation, IsNoneOfARunThatShowsNothing) {
  const std::vector<World> worlds{Nothing(0.8), Cause("X", 0.2)};
  const MatrixXd S = MatrixXd::Constant(1, 1, 4.0);
  EXPECT_NEAR(ExpectedInformation(S, S, worlds), 0.0, 1e-12);
}

// A run that shows everything tells all that is open.
TEST(ExpectedInformation, IsTheEntropyOfARunThatShowsEverything) {
  const std::vector<World> worlds{Nothing(0.8), Cause("X", 0.15), Cause("Y", 0.05)};
  const MatrixXd none = MatrixXd::Zero(2, 2), all = 1e12 * MatrixXd::Identity(2, 2);
  EXPECT_NEAR(ExpectedInformation(none, all, worlds), Bits({0.8, 0.15, 0.05}), 1e-3);
}

// Two causes that do the same: a run can show only whether one of them is there.
TEST(ExpectedInformation, LeavesOpenWhatDoesTheSame) {
  const std::vector<World> worlds{Nothing(0.8), Cause("X", 0.1), Cause("Y", 0.1)};
  const MatrixXd none = MatrixXd::Zero(2, 2), same = 1e12 * MatrixXd::Ones(2, 2);
  EXPECT_NEAR(ExpectedInformation(none, same, worlds), Bits({0.8, 0.2}), 1e-3);
}

// Between worlds of one group nothing is to be decided.
TEST(ExpectedInformation, CountsAGroupOnce) {
  std::vector<World> worlds{Nothing(0.8), Cause("X", 0.1), Cause("Y", 0.1)};
  worlds[1].group = worlds[2].group = "unknown";
  const MatrixXd none = MatrixXd::Zero(2, 2), all = 1e12 * MatrixXd::Identity(2, 2);
  EXPECT_NEAR(ExpectedInformation(none, all, worlds), Bits({0.8, 0.2}), 1e-3);
}

TEST(ExpectedInformation, GrowsWithWhatIsShown) {
  const std::vector<World> worlds{Nothing(0.7), Cause("X", 0.3)};
  const MatrixXd none = MatrixXd::Zero(1, 1);
  double before = 0.0;
  for (const double information : {1.0, 10.0, 100.0, 1e4, 1e6}) {
    const double bits = ExpectedInformation(none, MatrixXd::Constant(1, 1, information), worlds);
    EXPECT_GT(bits, before) << information;
    EXPECT_LT(bits, Bits({0.7, 0.3}));
    before = bits;
  }
}

// By hand: log evidence of a score m with information S is (m^2 / (S + 1) + S / (S + 1) - log(1 +
// S)) / 2.
TEST(ExpectedInformation, HasTheEvidenceOfTheLinearProblem) {
  const std::vector<World> worlds{Nothing(0.5), Cause("X", 0.5)};
  const double S = 9.0, m = 6.0;
  const VectorXd evidence =
      ExpectedEvidence(MatrixXd::Constant(1, 1, S), worlds, VectorXd::Constant(1, m));
  EXPECT_DOUBLE_EQ(evidence[0], 0.0);
  EXPECT_NEAR(evidence[1], 0.5 * (m * m / (S + 1) + S / (S + 1) - std::log(1 + S)), 1e-12);
}

}  // namespace expected_information_test
}  // namespace abbe
