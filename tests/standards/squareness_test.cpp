#include "standards/squareness.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "geometry/rotation.h"

namespace abbe::standards {
namespace squareness_test {

using Eigen::Vector3d;

// The direction of travel along `axis` whose reference line in the direction `across` has this
// slope.
Vector3d Travel(const Vector3d& axis, const Vector3d& across, double slope) {
  return axis + slope * across;
}

// The angle from a to b, positive by the right hand about `normal`.
double AngleFrom(const Vector3d& a, const Vector3d& b, const Vector3d& normal) {
  return std::atan2(a.cross(b).dot(normal), a.dot(b));
}

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();
constexpr double kFirst = 3e-4, kSecond = -1e-4;
constexpr double kNeglected = 1e-10;  // third order of 3e-4
constexpr double kRightAngle = std::numbers::pi / 2;

TEST(Squareness, C0YIsHowFarYTurnsFromItsRightAngleToX) {
  const double angle = AngleFrom(Travel(kX, kY, kFirst), Travel(kY, kX, kSecond), kZ);
  EXPECT_NEAR(SquarenessC0Y({kFirst, 0}, {kSecond, 0}), angle - kRightAngle, kNeglected);
}

TEST(Squareness, B0ZIsHowFarZTurnsFromItsRightAngleToX) {
  // Z stands at -90 degrees from X about +Y.
  const double angle = AngleFrom(Travel(kX, kZ, kFirst), Travel(kZ, kX, kSecond), kY);
  EXPECT_NEAR(SquarenessB0Z({kFirst, 0}, {kSecond, 0}), angle + kRightAngle, kNeglected);
}

TEST(Squareness, A0ZIsHowFarZTurnsFromItsRightAngleToY) {
  const double angle = AngleFrom(Travel(kY, kZ, kFirst), Travel(kZ, kY, kSecond), kX);
  EXPECT_NEAR(SquarenessA0Z({kFirst, 0}, {kSecond, 0}), angle - kRightAngle, kNeglected);
}

// A right-angled frame turned as a whole shows slopes in both lines and no squareness error.
TEST(Squareness, IsBlindToATurnOfTheWholeFrame) {
  const Eigen::Matrix3d R = geometry::ExpRotation<double>(Vector3d(2e-4, -1e-4, 3e-4));
  const Vector3d x = R * kX, y = R * kY, z = R * kZ;
  const auto line = [](double across, double along) { return Line{across / along, 0.0}; };
  // Second order of 3e-4.
  EXPECT_NEAR(SquarenessC0Y(line(x.y(), x.x()), line(y.x(), y.y())), 0, 1e-7);
  EXPECT_NEAR(SquarenessB0Z(line(x.z(), x.x()), line(z.x(), z.z())), 0, 1e-7);
  EXPECT_NEAR(SquarenessA0Z(line(y.z(), y.y()), line(z.y(), z.z())), 0, 1e-7);
}

}  // namespace squareness_test
}  // namespace abbe::standards
