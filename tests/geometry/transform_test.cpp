#include "geometry/transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace abbe::geometry {
namespace transform_test {

using Eigen::Vector3d;
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();

const Transform<double> kX_AB{RotationFromRollPitchYaw(0.3, -0.7, 2.1), Vector3d(1.0, -2.0, 0.5)};
const Transform<double> kX_BC{ExpRotation<double>(Vector3d(0.2, 0.1, -1.0)),
                              Vector3d(0.3, 0.4, -0.6)};
const Vector3d kPointInC(0.7, -0.1, 0.9);

TEST(Transform, CompositionIsTheProductOfHomogeneousMatrices) {
  EXPECT_LT(((kX_AB * kX_BC).Matrix() - kX_AB.Matrix() * kX_BC.Matrix()).norm(), kRounding);
}

TEST(Transform, CompositionMovesAPointInTwoSteps) {
  EXPECT_LT(((kX_AB * kX_BC) * kPointInC - kX_AB * (kX_BC * kPointInC)).norm(), kRounding);
}

TEST(Transform, InverseAfterForwardIsIdentity) {
  EXPECT_LT(((kX_AB.Inverse() * kX_AB).Matrix() - Eigen::Matrix4d::Identity()).norm(), kRounding);
  EXPECT_LT((kX_AB.Inverse() * (kX_AB * kPointInC) - kPointInC).norm(), kRounding);
}

// The T of the five-probe head paper at d = 0, written out entry by entry.
TEST(Transform, SmallErrorTransformIsTheMatrixOfTheHeadPaper) {
  const double EXX = 1e-6, EYX = -2e-6, EZX = 3e-6, EAX = 1e-4, EBX = -2e-4, ECX = 3e-4;
  Eigen::Matrix4d T;
  T << 1, -ECX, EBX, EXX, ECX, 1, -EAX, EYX, -EBX, EAX, 1, EZX, 0, 0, 0, 1;
  ErrorVector<double> errors;
  errors << EXX, EYX, EZX, EAX, EBX, ECX;
  EXPECT_EQ(SmallErrorTransform(errors).Matrix(), T);
}

TEST(Transform, SmallAndFullErrorTransformDifferInSecondOrder) {
  ErrorVector<double> errors;
  errors << 1e-6, -2e-6, 3e-6, 1e-3, -2e-3, 3e-3;
  const auto small = SmallErrorTransform(errors), full = ErrorTransform(errors);
  const double angle = errors.tail<3>().norm();
  EXPECT_EQ(small.p, full.p);
  EXPECT_NEAR((small.R - full.R).norm(), std::sqrt(0.5) * angle * angle, angle * angle * angle);
}

TEST(Transform, CastKeepsThePose) {
  const Transform<float> single = kX_AB.Cast<float>();
  EXPECT_EQ(single.p, kX_AB.p.cast<float>());
  EXPECT_EQ(single.R, kX_AB.R.cast<float>());
}

}  // namespace transform_test
}  // namespace abbe::geometry
