#include "rig/axis_errors.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace axis_errors_test {

constexpr int kSeeds = 1000;
constexpr double kTail = 5e-4;  // two-sided 99.9 %

void ExpectVariance(double sum_of_squares, double variance) {
  const boost::math::chi_squared distribution(kSeeds);
  EXPECT_GT(sum_of_squares / variance, quantile(distribution, kTail));
  EXPECT_LT(sum_of_squares / variance, quantile(complement(distribution, kTail)));
}

TEST(Rotation, IsOrthonormalAtAnyAngle) {
  for (const double angle : {0.0, 1e-9, 3e-4, 0.7, -2.9}) {
    const Eigen::Matrix3d turn = FullRotation(angle, -0.6 * angle, 1.1 * angle);
    const Eigen::Matrix3d product = turn * turn.transpose();
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 8 * 2.2e-16);
    EXPECT_NEAR(turn.determinant(), 1.0, 8 * 2.2e-16);
  }
}

TEST(Rotation, TurnsByTheRightHandRuleXFirst) {
  const double quarter = std::acos(0.0);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  EXPECT_LT((FullRotation(quarter, 0, 0) * y - z).norm(), 1e-15);
  EXPECT_LT((FullRotation(0, quarter, 0) * z - x).norm(), 1e-15);
  EXPECT_LT((FullRotation(0, 0, quarter) * x - y).norm(), 1e-15);
  // y goes to z by Rx, and z to x by Ry; Ry first would leave y where it is for Rx to take to z.
  EXPECT_LT((FullRotation(quarter, quarter, 0) * y - x).norm(), 1e-15);
}

TEST(AxisErrors, AreZeroAtTheReference) {
  const RigSettings settings = DemoRig();
  for (int axis = 0; axis < kAxes; ++axis) {
    EXPECT_EQ(AxisErrors(settings, axis, 11).At(settings.travels[axis].first).norm(), 0.0);
    EXPECT_GT(AxisErrors(settings, axis, 11).At(0.03).norm(), 0.0);
  }
}

TEST(AxisErrors, StraightnessHasNoSlope) {
  const RigSettings settings = DemoRig();
  const AxisErrors errors(settings, 0, 3);
  constexpr int kCells = 3000;
  Motions product = Motions::Zero();
  double square = 0.0;
  for (int i = 0; i < kCells; ++i) {
    const double x = 0.06 * (i + 0.5) / kCells;
    product += (x - 0.03) * errors.At(x);
    square += (x - 0.03) * (x - 0.03);
  }
  // Midpoint rules differ by the square of the coarser one's cell, 0.01 correlation lengths, times
  // the slope of an error of 1 um over 15 mm.
  const double fineness = 0.01 * 0.01 * 67e-6;
  EXPECT_LT(std::abs(product[1] / square), fineness);
  EXPECT_LT(std::abs(product[2] / square), fineness);
  EXPECT_GT(std::abs(product[4] / square), 1e-6);  // an angle keeps its slope
}

// Relative to the reference an angle's variance is 2 sd^2 (1 - correlation).
TEST(AxisErrors, ComeFromThePopulation) {
  const RigSettings settings = DemoRig();
  const double at = 0.02;
  const double apart = at / settings.population.smoothness;
  const double relative = 2.0 * (1.0 - std::exp(-0.5 * apart * apart));
  double roll = 0.0, pitch_y = 0.0, positioning = 0.0, scale = 0.0, a0z = 0.0, c0y = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const AxisErrors x(settings, 0, seed), y(settings, 1, seed);
    roll += std::pow(x.At(at)[3], 2);
    pitch_y += std::pow(y.At(at)[3], 2);
    positioning += std::pow(x.At(at)[0] - x.scale() * at, 2);
    scale += std::pow(x.scale(), 2);
    a0z += std::pow(Squareness::Draw(settings, seed).a0z, 2);
    c0y += std::pow(Squareness::Draw(settings, seed).c0y, 2);
  }
  ExpectVariance(roll, relative * 20e-6 * 20e-6);
  ExpectVariance(pitch_y, relative * 20e-6 * 20e-6);
  ExpectVariance(positioning, relative * 2e-6 * 2e-6);
  ExpectVariance(scale, 20e-6 * 20e-6);
  ExpectVariance(a0z, 30e-6 * 30e-6);
  ExpectVariance(c0y, 30e-6 * 30e-6);
}

TEST(AxisErrors, AreIndependentOfOneAnother) {
  const RigSettings settings = DemoRig();
  double product = 0.0, axes = 0.0, a2 = 0.0, b2 = 0.0, c2 = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const double a = AxisErrors(settings, 0, seed).At(0.03)[3];
    const double b = AxisErrors(settings, 0, seed).At(0.03)[4];
    const double c = AxisErrors(settings, 2, seed).At(0.03)[3];
    product += a * b;
    axes += a * c;
    a2 += a * a;
    b2 += b * b;
    c2 += c * c;
  }
  const double band = 3.5 / std::sqrt(kSeeds);  // 3.5 standard deviations of a correlation of 0
  EXPECT_LT(std::abs(product) / std::sqrt(a2 * b2), band);
  EXPECT_LT(std::abs(axes) / std::sqrt(a2 * c2), band);
}

TEST(AxisErrors, NamesAreThoseOfIso230) {
  EXPECT_EQ(MotionName(0, 1), "EYX");
  EXPECT_EQ(MotionName(2, 3), "EAZ");
}

}  // namespace axis_errors_test
}  // namespace abbe::rig
