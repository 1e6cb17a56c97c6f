#include "geometry/rotation.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace abbe::geometry {
namespace rotation_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A handful of products and sums of numbers of size 1.
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

// Zero, near zero, on both sides of the switch to the series (0.01), large, near and at half a
// turn.
std::vector<Vector3d> RotationVectors() {
  std::vector<Vector3d> vectors{Vector3d::Zero()};
  const Vector3d axes[] = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ(),
                           Vector3d(1, -2, 3).normalized(), Vector3d(-3, 1, 0.5).normalized()};
  for (const Vector3d& axis : axes) {
    for (const double angle : {1e-12, 1e-6, 0.00999, 0.01001, 0.3, 1.7, 3.0, kPi - 1e-7, kPi}) {
      vectors.push_back(angle * axis);
    }
  }
  return vectors;
}

TEST(Rotation, AboutAnAxisCarriesTheNextAxisIntoTheOneAfter) {
  EXPECT_LT((RotationX(kPi / 2) * Vector3d::UnitY() - Vector3d::UnitZ()).norm(), kRounding);
  EXPECT_LT((RotationY(kPi / 2) * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), kRounding);
  EXPECT_LT((RotationZ(kPi / 2) * Vector3d::UnitX() - Vector3d::UnitY()).norm(), kRounding);
}

TEST(Rotation, RollPitchYawAppliesTheRollFirst) {
  const Eigen::AngleAxisd roll(0.3, Vector3d::UnitX()), pitch(-0.7, Vector3d::UnitY()),
      yaw(2.1, Vector3d::UnitZ());
  const Matrix3d oracle = (yaw * pitch * roll).toRotationMatrix();
  EXPECT_LT((RotationFromRollPitchYaw(0.3, -0.7, 2.1) - oracle).norm(), kRounding);
}

TEST(Rotation, SkewIsTheCrossProduct) {
  const Vector3d a(1, -2, 3), b(0.5, 4, -1);
  EXPECT_EQ(Skew<double>(a) * b, a.cross(b));
}

TEST(Rotation, ExpAgreesWithEigen) {
  for (const Vector3d& v : RotationVectors()) {
    const double angle = v.norm();
    const Vector3d axis = angle > 0 ? Vector3d(v / angle) : Vector3d::UnitX();
    const Matrix3d oracle = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LT((ExpRotation<double>(v) - oracle).norm(), kRounding) << v.transpose();
  }
}

TEST(Rotation, LogIsTheInverseOfExp) {
  for (const Vector3d& v : RotationVectors()) {
    const Vector3d back = LogRotation<double>(ExpRotation<double>(v));
    // At half a turn v and -v are the same rotation.
    const double difference =
        v.norm() < kPi ? (back - v).norm() : std::min((back - v).norm(), (back + v).norm());
    EXPECT_LT(difference, kRounding) << v.transpose();
  }
}

TEST(Rotation, LogKeepsTheDigitsOfATinyRotation) {
  const Vector3d v(1e-9, -2e-9, 0.5e-9);
  EXPECT_LT((LogRotation<double>(ExpRotation<double>(v)) - v).norm(), kRounding * v.norm());
}

TEST(Rotation, SmallRotationNeglectsHalfTheSquareOfTheAngle) {
  const Vector3d direction = Vector3d(1, -2, 3).normalized();
  for (const double angle : {1e-2, 1e-3, 1e-4}) {
    const Vector3d v = angle * direction;
    const double error = (SmallRotation<double>(v) - ExpRotation<double>(v)).norm();
    // exp - I - S = S^2 / 2 + O(angle^3), and |S^2| = sqrt(2) angle^2 in the Frobenius norm.
    EXPECT_NEAR(error, std::sqrt(0.5) * angle * angle, angle * angle * angle);
  }
}

TEST(Rotation, DerivativesAtZeroAreTheGenerators) {
  using Jet = ceres::Jet<double, 3>;
  const Eigen::Vector3<Jet> v(Jet(0.0, 0), Jet(0.0, 1), Jet(0.0, 2));
  const Eigen::Matrix3<Jet> R = ExpRotation<Jet>(v);
  const Eigen::Vector3<Jet> log = LogRotation<Jet>(R);
  for (int k = 0; k < 3; ++k) {
    const Matrix3d generator = Skew<double>(Vector3d::Unit(k));
    for (int i = 0; i < 9; ++i) EXPECT_EQ(R(i / 3, i % 3).v[k], generator(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(log[i].v[k], i == k ? 1.0 : 0.0);
  }
}

TEST(Rotation, DerivativesOfExpAgreeWithFiniteDifferences) {
  using Jet = ceres::Jet<double, 3>;
  constexpr double kStep = 1e-5;  // truncation h^2/6, rounding eps/h: both about 2e-11
  for (const Vector3d& v : {Vector3d(0.004, 0.003, -0.002), Vector3d(0.5, -1.1, 0.8)}) {
    const Eigen::Vector3<Jet> jets(Jet(v[0], 0), Jet(v[1], 1), Jet(v[2], 2));
    const Eigen::Matrix3<Jet> R = ExpRotation<Jet>(jets);
    for (int k = 0; k < 3; ++k) {
      const Matrix3d difference = (ExpRotation<double>(v + kStep * Vector3d::Unit(k)) -
                                   ExpRotation<double>(v - kStep * Vector3d::Unit(k))) /
                                  (2 * kStep);
      for (int i = 0; i < 9; ++i) {
        EXPECT_NEAR(R(i / 3, i % 3).v[k], difference(i / 3, i % 3), 1e-10);
      }
    }
  }
}

// d log(exp(v)) / dv is the identity: derivatives through both functions at once.
TEST(Rotation, DerivativesOfLogInvertThoseOfExp) {
  using Jet = ceres::Jet<double, 3>;
  for (const Vector3d& v : {Vector3d(1e-9, 0, 0), Vector3d(0.004, 0.003, -0.002),
                            Vector3d(0.5, -1.1, 0.8), Vector3d(-2.1, 1.9, 0.7)}) {
    const Eigen::Vector3<Jet> jets(Jet(v[0], 0), Jet(v[1], 1), Jet(v[2], 2));
    const Eigen::Vector3<Jet> back = LogRotation<Jet>(ExpRotation<Jet>(jets));
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        // Just above the switch (0.01) division by the angle costs two digits.
        EXPECT_NEAR(back[i].v[k], i == k ? 1.0 : 0.0, 100 * kRounding);
      }
    }
  }
}

// d R R' is the cross product with J d: by dual numbers through ExpRotation. The closed form loses
// three digits just above its switch to the series.
TEST(Rotation, TheLeftJacobianIsThatOfDualNumbers) {
  using Jet = ceres::Jet<double, 3>;
  for (const Vector3d& v : RotationVectors()) {
    Eigen::Vector3<Jet> dual;
    for (int i = 0; i < 3; ++i) dual[i] = Jet(v[i], i);
    const Eigen::Matrix3<Jet> R = ExpRotation<Jet>(dual);
    const Matrix3d J = ExpRotationJacobian<double>(v);
    for (int i = 0; i < 3; ++i) {
      const Matrix3d dR = R.unaryExpr([i](const Jet& jet) { return jet.v[i]; });
      const Matrix3d cross = dR * ExpRotation<double>(v).transpose();
      EXPECT_LT((cross - Skew<double>(J.col(i))).norm(), 1e3 * kRounding) << v.transpose();
    }
  }
}

}  // namespace rotation_test
}  // namespace abbe::geometry
