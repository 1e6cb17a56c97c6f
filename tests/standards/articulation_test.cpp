#include "standards/articulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "failure/failure.h"

namespace abbe::standards {
namespace articulation_test {

constexpr double kRounding = 1e-14;

TEST(SmallestEnclosingSphere, KnownSpheres) {
  Eigen::Matrix3Xd one(3, 1);
  one << 1, 2, 3;
  EXPECT_EQ(SmallestEnclosingSphere(one).radius, 0.0);

  Eigen::Matrix3Xd pair(3, 3);  // the third inside
  pair << 0, 2, 1, 0, 0, 0.5, 0, 0, 0;
  EXPECT_NEAR(SmallestEnclosingSphere(pair).radius, 1.0, kRounding);

  Eigen::Matrix3Xd triangle(3, 3);  // equilateral, side 1, in a tilted place
  triangle << 5, 6, 5.5, 7, 7, 7 + std::sqrt(0.75), 1, 1, 1;
  EXPECT_NEAR(SmallestEnclosingSphere(triangle).radius, 1 / std::sqrt(3.0), kRounding);

  Eigen::Matrix3Xd tetrahedron(3, 4);  // corners of the cube of side 2
  tetrahedron << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  const Sphere sphere = SmallestEnclosingSphere(tetrahedron);
  EXPECT_NEAR(sphere.radius, std::sqrt(3.0), kRounding);
  EXPECT_NEAR(sphere.centre.norm(), 0.0, kRounding);

  Eigen::Matrix3Xd obtuse(3, 3);  // the longest side is a diameter
  obtuse << -1, 1, 0, 0, 0, 0.1, 0, 0, 0;
  EXPECT_NEAR(SmallestEnclosingSphere(obtuse).radius, 1.0, kRounding);

  Eigen::Matrix3Xd equal = Eigen::Matrix3Xd::Constant(3, 5, 0.1);
  EXPECT_NEAR(SmallestEnclosingSphere(equal).radius, 0.0, kRounding);
}

// Four poses at +-1 um along x and +-2 um along y about (0.1, 0.2, 0.3).
TEST(Articulation, FiguresByHand) {
  Eigen::Matrix3Xd p(3, 4);
  p << 1e-6, -1e-6, 0, 0, 0, 0, 2e-6, -2e-6, 0, 0, 0, 0;
  p.colwise() += Eigen::Vector3d(0.1, 0.2, 0.3);
  const Articulation figures = EvaluateArticulation(p);
  // Coordinates of 0.3 m carry 5e-17 m of rounding each.
  constexpr double kRound = 1e-15;
  EXPECT_NEAR((figures.mean - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 0.0, kRound);
  EXPECT_NEAR(figures.location, 4e-6, kRound);
  EXPECT_NEAR(figures.largest, 2e-6, kRound);
  EXPECT_NEAR(figures.range, 1e-6, kRound);
  EXPECT_NEAR(figures.two_sigma, 2 * std::sqrt(10e-12 / 3), kRound);
}

TEST(Articulation, NeedsTwoPosesOfFiniteNumbers) {
  EXPECT_THROW(EvaluateArticulation(Eigen::Matrix3Xd::Zero(3, 1)), InputError);
  Eigen::Matrix3Xd p = Eigen::Matrix3Xd::Zero(3, 3);
  p(1, 1) = std::nan("");
  EXPECT_THROW(EvaluateArticulation(p), InputError);
}

}  // namespace articulation_test
}  // namespace abbe::standards
