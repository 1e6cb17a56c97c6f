// The batch functions of the linkage with each width of vectors, against the equations of the paper
// in 64 bits of mantissa and against the functions of single poses.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "random/counter_random.h"
#include "relm/pivot_linkage.h"
#include "tests/each_width.h"

namespace abbe::relm {
namespace pivot_linkage_batch_test {

using Eigen::Index, Eigen::Matrix3Xd, Eigen::Vector3d;

constexpr double kL1 = 0.130, kL2 = 0.110;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr Branch kBranches[] = {
    {Elbow::kUp, false}, {Elbow::kDown, false}, {Elbow::kUp, true}, {Elbow::kDown, true}};

Eigen::Vector3<long double> TrueTip(const Vector3d& angles) {
  const Eigen::Vector3<long double> q = angles.cast<long double>();
  const long double r =
      kL2 * std::cos(q[2]) * std::sin(q[1]) + std::cos(q[1]) * (kL1 + kL2 * std::sin(q[2]));
  return {std::cos(q[0]) * r, std::sin(q[0]) * r,
          kL2 * std::cos(q[1]) * std::cos(q[2]) - std::sin(q[1]) * (kL1 + kL2 * std::sin(q[2]))};
}

Matrix3Xd Uniform(Index columns, double size) {
  Matrix3Xd m(3, columns);
  for (Index i = 0; i < columns; ++i) {
    for (int k = 0; k < 3; ++k) m(k, i) = random::CounterRandom(1, k).Uniform(i, -size, size);
  }
  return m;
}

TEST(PivotLinkageBatch, HasTipsWithinThreeRoundingsOfTheReach) {
  const PivotLinkage linkage(kL1, kL2);
  for (const double size : {7.0, 1e5}) {
    const Matrix3Xd q = Uniform(20000, size);
    test::OnEachWidth([&] {
      Matrix3Xd p;
      linkage.Tips(q, p);
      double worst = 0;
      for (Index i = 0; i < q.cols(); ++i) {
        const auto error = (p.col(i).cast<long double>() - TrueTip(q.col(i))).eval();
        worst = std::max(worst, static_cast<double>(error.cwiseAbs().maxCoeff()));
      }
      EXPECT_LT(worst, 3 * kEpsilon * (kL1 + kL2));
    });
  }
}

// An error of 2.5 units in an arc tangent is up to 4 eps; sine is off by a few eps of the square
// of the reach over 2 L1 L2, and the arc cosine magnifies that by 1 / cos q3.
TEST(PivotLinkageBatch, HasTheAnglesOfSinglePoses) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd p = Uniform(20000, kL1 + kL2);
  test::OnEachWidth([&] {
    for (const Branch& branch : kBranches) {
      Matrix3Xd q;
      std::vector<Reach> reach;
      Index reached = linkage.AnglesOf(p, branch, q, reach);
      for (Index i = 0; i < p.cols(); ++i) {
        const auto one = linkage.FindAngles(p.col(i), branch);
        ASSERT_EQ(reach[i], linkage.ReachOf(p.col(i)));
        if (!one) {
          EXPECT_EQ(q.col(i), Vector3d::Zero());
          continue;
        }
        const double singular =
            std::min(std::abs(std::cos((*one)[2])), p.col(i).norm() / (kL1 + kL2));
        ASSERT_LT((q.col(i) - *one).cwiseAbs().maxCoeff(), 32 * kEpsilon / singular) << i;
        --reached;
      }
      EXPECT_EQ(reached, 0);
    }
  });
}

TEST(PivotLinkageBatch, ReturnsToTheTips) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd p = Uniform(4001, 0.1);
  test::OnEachWidth([&] {
    for (const Branch& branch : kBranches) {
      Matrix3Xd q, back;
      std::vector<Reach> reach;
      linkage.AnglesOf(p, branch, q, reach);
      linkage.Tips(q, back);
      for (Index i = 0; i < p.cols(); ++i) {
        if (reach[i] == Reach::kReached) {
          EXPECT_LT((back.col(i) - p.col(i)).norm(), 32 * kEpsilon * (kL1 + kL2)) << i;
        }
      }
    }
  });
}

// From no pose to more than two vectors of the widest, at addresses that no vector is aligned to.
TEST(PivotLinkageBatch, DoesNotDependOnTheNumberOfPosesNorOnTheirPlace) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd q = Uniform(40, 3);
  test::OnEachWidth([&] {
    Matrix3Xd all, all_back;
    std::vector<Reach> all_reach;
    linkage.Tips(q, all);
    linkage.AnglesOf(all, {}, all_back, all_reach);
    for (Index first = 0; first < 9; ++first) {
      for (Index count = 0; count <= 18; ++count) {
        Matrix3Xd p, back;
        std::vector<Reach> reach;
        linkage.Tips(q.middleCols(first, count), p);
        ASSERT_EQ(p, all.middleCols(first, count));
        const Index reached = linkage.AnglesOf(all.middleCols(first, count), {}, back, reach);
        ASSERT_EQ(back, all_back.middleCols(first, count));
        ASSERT_EQ(reach,
                  std::vector<Reach>(all_reach.begin() + first, all_reach.begin() + first + count));
        ASSERT_EQ(reached, std::count(reach.begin(), reach.end(), Reach::kReached));
      }
    }
  });
}

bool Same(const Vector3d& a, const Vector3d& b) {
  for (int k = 0; k < 3; ++k) {
    if (!(a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k])))) return false;
  }
  return true;
}

// Each alone among poses that a vector does; its neighbours stay what they are.
TEST(PivotLinkageBatch, DoesStrangeAnglesAsSinglePosesDo) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd usual = Uniform(19, 3);
  test::OnEachWidth([&] {
    Matrix3Xd of_usual;
    linkage.Tips(usual, of_usual);
    for (const double strange : {kNaN, kInfinity, -kInfinity, 1e7, -1e22, 1e300}) {
      for (Index at = 0; at < usual.cols(); ++at) {
        Matrix3Xd q = usual, p;
        q(at % 3, at) = strange;
        linkage.Tips(q, p);
        EXPECT_TRUE(Same(p.col(at), linkage.Tip(q.col(at)))) << strange;
        p.col(at) = of_usual.col(at);
        EXPECT_EQ(p, of_usual);
      }
    }
  });
}

TEST(PivotLinkageBatch, DoesStrangeTipsAsSinglePosesDo) {
  const PivotLinkage linkage(kL1, kL2);
  const Matrix3Xd usual = Uniform(19, 0.1);
  const Vector3d strange[] = {{kNaN, 0.1, 0.1},
                              {0.1, 0.1, kNaN},
                              {kInfinity, 0, 0},
                              {0, 0, -kInfinity},
                              {1e200, 1e200, 0},
                              {1, 0, 0},                // too far
                              {kL1 + kL2, 0, 0},        // straight
                              {(kL1 - kL2) / 2, 0, 0},  // too near
                              {0, 0, 0},
                              {0, 0, 0.2},  // on the axis
                              {1e-8, -1e-8, 0.2},
                              {1e-200, 0, 0.2}};
  test::OnEachWidth([&] {
    for (const Branch& branch : kBranches) {
      Matrix3Xd of_usual;
      std::vector<Reach> reach, usual_reach;
      linkage.AnglesOf(usual, branch, of_usual, usual_reach);
      for (const Vector3d& tip : strange) {
        for (Index at = 0; at < usual.cols(); ++at) {
          Matrix3Xd p = usual, q;
          p.col(at) = tip;
          linkage.AnglesOf(p, branch, q, reach);
          EXPECT_EQ(q.col(at), Vector3d::Zero());
          EXPECT_EQ(reach[at], linkage.ReachOf(tip)) << tip.transpose();
          EXPECT_NE(reach[at], Reach::kReached);
          q.col(at) = of_usual.col(at);
          reach[at] = usual_reach[at];
          EXPECT_EQ(q, of_usual);
          EXPECT_EQ(reach, usual_reach);
        }
      }
    }
  });
}

TEST(PivotLinkageBatch, MayWriteOverItsInput) {
  const PivotLinkage linkage(kL1, kL2);
  Matrix3Xd q = Uniform(21, 3);
  q(1, 4) = 1e9;
  test::OnEachWidth([&] {
    Matrix3Xd apart, over = q;
    linkage.Tips(q, apart);
    linkage.Tips(over, over);
    EXPECT_EQ(over, apart);
  });
}

}  // namespace pivot_linkage_batch_test
}  // namespace abbe::relm
