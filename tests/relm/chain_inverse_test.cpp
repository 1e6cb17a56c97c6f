#include "relm/chain_inverse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "failure/failure.h"
#include "linkage_by_matrices.h"
#include "relm/pivot_linkage.h"

namespace abbe::relm {
namespace chain_inverse_test {

using Eigen::Vector3d;
using Eigen::VectorXd;
using ::testing::HasSubstr;

SerialChain Shipped() { return TestLinkage().chain; }

// Over the workspace: all four branches of the closed form, and no other.
TEST(ChainInverse, FindsTheBranchesOfTheClosedForm) {
  const PivotLinkage linkage(kLink1, kLink2);
  const ChainInverse inverse(Shipped());
  for (const Vector3d& p : {Vector3d(0.15, 0.05, 0.05), Vector3d(-0.1, 0.1, -0.05),
                            Vector3d(0.02, -0.2, 0.08), Vector3d(0.06, 0.03, -0.19)}) {
    const auto found = inverse.Branches(p);
    ASSERT_EQ(found.size(), 4U);
    for (const Elbow elbow : {Elbow::kUp, Elbow::kDown}) {
      for (const bool over : {false, true}) {
        const VectorXd q = linkage.Angles(p, {elbow, over});
        EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const VectorXd& other) {
          return (Unwrapped(other, q) - q).norm() < 1e-9;  // 1e-12 of the reach, near singular more
        }));
      }
    }
  }
}

TEST(ChainInverse, StaysOnTheBranchAlongAPath) {
  const PivotLinkage linkage(kLink1, kLink2);
  const ChainInverse inverse(Shipped());
  for (const Elbow elbow : {Elbow::kUp, Elbow::kDown}) {
    VectorXd q = linkage.Angles({0.15, -0.06, 0.0}, {elbow});
    for (double y = -0.06; y < 0.06; y += 0.005) {
      const Vector3d p(0.15, y, 0.0);
      q = inverse.Angles(p, q);
      EXPECT_LT((q - linkage.Angles(p, {elbow})).norm(), 1e-9);
    }
  }
}

TEST(ChainInverse, SaysHowFarABallOutOfReachIs) {
  const ChainInverse inverse(Shipped());
  const Vector3d far(0.3, 0, 0), start(0.1, 0.1, 0.5);
  EXPECT_FALSE(inverse.Find(far, start).has_value());
  EXPECT_TRUE(inverse.Branches(far).empty());
  try {
    inverse.Angles(far, start);
    ADD_FAILURE();
  } catch (const NumericalError& error) {  // the links reach 240 mm of the 300
    EXPECT_THAT(error.what(), HasSubstr("(300.000, 0.000, 0.000) mm: 60 mm are left"));
  }
}

TEST(ChainInverse, RefusesASingularPose) {
  const ChainInverse inverse(Shipped());
  const Vector3d on_axis(0, 0, 0.15);
  const VectorXd there = PivotLinkage(kLink1, kLink2).Angles({1e-6, 0, 0.15}, {});
  EXPECT_FALSE(inverse.Find(on_axis, there).has_value());
  try {
    inverse.Angles(on_axis, there);
    ADD_FAILURE();
  } catch (const NumericalError& error) {
    EXPECT_THAT(error.what(), HasSubstr("singular at (0.000, 0.000, 150.000) mm"));
    EXPECT_THAT(error.what(), HasSubstr("stay away"));
  }
}

TEST(ChainInverse, OfTwoJointsIsSingularEverywhere) {
  const SerialChain two(
      {{Vector3d::Zero(), Vector3d::UnitZ()}, {Vector3d(0.1, 0, 0), Vector3d::UnitZ()}},
      Vector3d(0.2, 0, 0));
  const Eigen::Vector2d q(0.3, 0.8);
  EXPECT_THROW(ChainInverse(two).Angles(two.Tip(VectorXd(q)), q), NumericalError);
}

TEST(ChainInverse, RefusesTheWrongNumberOfJoints) {
  EXPECT_THROW(ChainInverse(Shipped()).Find(Vector3d::Zero(), Eigen::Vector2d::Zero()), InputError);
  const SerialChain four({{Vector3d::Zero(), Vector3d::UnitZ()},
                          {Vector3d(0.1, 0, 0), Vector3d::UnitY()},
                          {Vector3d(0.2, 0, 0), Vector3d::UnitY()},
                          {Vector3d(0.3, 0, 0), Vector3d::UnitZ()}},
                         Vector3d(0.4, 0, 0));
  EXPECT_THROW(ChainInverse(four).Branches(Vector3d(0.2, 0, 0)), InputError);
}

}  // namespace chain_inverse_test
}  // namespace abbe::relm
