#include "relm/pivot_linkage.h"

#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"

namespace abbe::relm {
namespace pivot_linkage_test {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kL1 = 0.130, kL2 = 0.110;
constexpr double kRight = std::numbers::pi / 2;
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon() * (kL1 + kL2);

// Equations 1 to 3 of the RELM paper, term by term.
template <typename T>
Eigen::Matrix<T, 3, 1> AsPrinted(const T& q1, const T& q2, const T& q3) {
  using std::cos, std::sin;
  return {cos(q1) * (T(kL2) * cos(q3) * sin(q2) + cos(q2) * (T(kL1) + T(kL2) * sin(q3))),
          sin(q1) * (T(kL2) * cos(q3) * sin(q2) + cos(q2) * (T(kL1) + T(kL2) * sin(q3))),
          T(kL2) * cos(q2) * cos(q3) - sin(q2) * (T(kL1) + T(kL2) * sin(q3))};
}

Matrix3Xd AnyAngles(Eigen::Index poses) {
  Matrix3Xd q(3, poses);
  for (Eigen::Index i = 0; i < poses; ++i) {
    for (int k = 0; k < 3; ++k) q(k, i) = random::CounterRandom(1, k).Uniform(i, -7, 7);
  }
  return q;
}

TEST(PivotLinkage, PutsTheBallWhereTheEquationsOfThePaperPutIt) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd angles = AnyAngles(200);
  for (const Vector3d q : angles.colwise()) {
    EXPECT_LT((linkage.Tip(q) - AsPrinted(q[0], q[1], q[2])).norm(), kRounding);
  }
}

TEST(PivotLinkage, PutsTheBallWhereADrawingPutsIt) {
  const PivotLinkage linkage(kL1, kL2);
  const std::vector<std::pair<Vector3d, Vector3d>> drawn = {
      {{0, 0, 0}, {kL1, 0, kL2}},                 // link 1 along x, link 2 upright
      {{kRight, 0, 0}, {0, kL1, kL2}},            // the same, turned to y
      {{kRight, 0, kRight}, {0, kL1 + kL2, 0}},   // stretched along y
      {{0, -kRight, 0}, {-kL2, 0, kL1}},          // link 1 upright, link 2 leans back over
      {{0, kRight, kRight}, {0, 0, -kL1 - kL2}},  // hangs
      {{0, 0, -kRight}, {kL1 - kL2, 0, 0}},       // folded
  };
  for (const auto& [q, p] : drawn) EXPECT_LT((linkage.Tip(q) - p).norm(), kRounding);
}

TEST(PivotLinkage, HasTheDerivativesOfTheEquations) {
  using Jet = ceres::Jet<double, 3>;
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd angles = AnyAngles(200);
  for (const Vector3d q : angles.colwise()) {
    const auto p = AsPrinted(Jet(q[0], 0), Jet(q[1], 1), Jet(q[2], 2));
    const Eigen::Matrix3d J = linkage.JacobianTipAngles(q);
    for (int row = 0; row < 3; ++row)
      EXPECT_LT((J.row(row).transpose() - p[row].v).norm(), kRounding);
  }
}

// |det| = r L1 L2 |cos q3|: what makes a pose singular.
TEST(PivotLinkage, IsSingularInLineAndOnTheAxis) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd angles = AnyAngles(200);
  for (const Vector3d q : angles.colwise()) {
    const Vector3d p = linkage.Tip(q);
    const double expected = std::hypot(p.x(), p.y()) * kL1 * kL2 * std::cos(q[2]);
    EXPECT_NEAR(std::abs(linkage.JacobianTipAngles(q).determinant()), std::abs(expected), 1e-17);
  }
}

// Not a multiple of the block that the batch functions work in. The vector functions of the C
// library are right to 4 units in the last place.
TEST(PivotLinkage, SaysTheSameForManyPosesAsForOne) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd q = AnyAngles(1003);
  Matrix3Xd p, back;
  std::vector<Reach> reach;
  linkage.Tips(q, p);
  ASSERT_EQ(p.cols(), 1003);
  p.col(17) = Vector3d(1, 0, 0);  // too far
  for (const Branch branch : {Branch{Elbow::kUp, false}, Branch{Elbow::kDown, false},
                              Branch{Elbow::kUp, true}, Branch{Elbow::kDown, true}}) {
    Eigen::Index reached = linkage.AnglesOf(p, branch, back, reach);
    for (Eigen::Index i = 0; i < p.cols(); ++i) {
      if (i != 17) {
        EXPECT_LT((p.col(i) - linkage.Tip(q.col(i))).norm(), kRounding);
      }
      const auto one = linkage.FindAngles(p.col(i), branch);
      EXPECT_EQ(reach[static_cast<std::size_t>(i)], linkage.ReachOf(p.col(i)));
      EXPECT_EQ(one.has_value(), reach[static_cast<std::size_t>(i)] == Reach::kReached);
      EXPECT_LT((back.col(i) - one.value_or(Vector3d::Zero())).norm(), 1e-12);
      reached -= one.has_value() ? 1 : 0;
    }
    EXPECT_EQ(reached, 0);
  }
}

TEST(PivotLinkage, TellsWhyAPoseHasNoAngles) {
  const PivotLinkage linkage(kL1, kL2);
  const double sum = kL1 + kL2, difference = kL1 - kL2;
  struct Pose {
    Vector3d p;
    Reach reach;
    const char* what;
    const char* to_do;
  };
  const std::vector<Pose> poses = {
      {{sum + 1e-6, 0, 0}, Reach::kTooFar, "out of reach: 240.001 mm", "move the base nearer"},
      {{0, 0, -1.0}, Reach::kTooFar, "links reach 240.000 mm", "move the base nearer"},
      {{0, difference - 1e-6, 0}, Reach::kTooNear, "links fold to 20.000 mm", "move the base away"},
      {{0, 0, 0}, Reach::kTooNear, "0.000 mm from pivot 2", "move the base away"},
      {{0, (sum - 1e-15), 0}, Reach::kStraight, "links are in line", "edge of the workspace"},
      {{0, (difference + 1e-15), 0}, Reach::kStraight, "links are in line", "edge"},
      {{0, 0, 0.15}, Reach::kOnAxis, "axis of pivot 1 at z = 150.000 mm", "move the base sideways"},
      {{0, 1e-8, -0.15}, Reach::kOnAxis, "axis of pivot 1", "move the base sideways"},
  };
  for (const Pose& pose : poses) {
    EXPECT_EQ(linkage.ReachOf(pose.p), pose.reach) << pose.what;
    EXPECT_FALSE(linkage.FindAngles(pose.p, {}).has_value()) << pose.what;
    try {
      linkage.Angles(pose.p, {});
      ADD_FAILURE() << pose.what;
    } catch (const NumericalError& error) {
      EXPECT_THAT(error.what(), HasSubstr(pose.what));
      EXPECT_THAT(error.what(), HasSubstr(pose.to_do));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(PivotLinkage, HasLinksOfPositiveFiniteLength) {
  for (const double bad : {0.0, -0.1, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(PivotLinkage(bad, kL2), InputError);
    EXPECT_THROW(PivotLinkage(kL1, bad), InputError);
  }
}

TEST(Unwrapped, GoesThroughTheHalfTurnWithoutAJump) {
  const double turn = 2 * std::numbers::pi;
  const Eigen::Vector3d near(3.1, -3.1, 20.0), angles(-3.1, 3.1, 1.0);
  const Eigen::VectorXd found = Unwrapped(angles, near);
  EXPECT_NEAR(found[0], turn - 3.1, 1e-14);
  EXPECT_NEAR(found[1], 3.1 - turn, 1e-14);
  EXPECT_NEAR(found[2], 1 + 3 * turn, 1e-14);
}

}  // namespace pivot_linkage_test
}  // namespace abbe::relm
