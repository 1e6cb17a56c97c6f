#include "machine/volumetric_jacobian.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <limits>

#include "volumetric_cases.h"

namespace abbe::machine {
namespace volumetric_jacobian_test {

using Eigen::Vector3d;

constexpr double kEps = std::numeric_limits<double>::epsilon();

// Every derivative at once, by dual numbers through the template: 18 motions, 3 squarenesses,
// position, tool.
constexpr int kInputs = kAxes * kMotions + 3 + 3 + 3;
using Jet = ceres::Jet<double, kInputs>;

Eigen::Matrix<double, 3, kInputs> ByJets(const Chain& chain, const Vector3d& position,
                                         const Vector3d& p_TQ, const MotionErrors<double>& errors) {
  int input = 0;
  const auto seed = [&](const auto& values) {
    Eigen::Matrix<Jet, std::decay_t<decltype(values)>::RowsAtCompileTime, 1> jets;
    for (Eigen::Index i = 0; i < values.size(); ++i) jets[i] = Jet(values[i], input++);
    return jets;
  };
  MotionErrors<Jet> e;
  for (int axis = 0; axis < kAxes; ++axis) e.axes[axis] = seed(errors.axes[axis]);
  e.squareness = seed(errors.squareness);
  const Eigen::Vector3<Jet> q = seed(position), tool = seed(p_TQ);
  const Eigen::Vector3<Jet> error = VolumetricError<Jet>(chain, q, tool, e);
  Eigen::Matrix<double, 3, kInputs> J;
  for (int row = 0; row < 3; ++row) J.row(row) = error[row].v.transpose();
  return J;
}

// Angles from none over small (the series of the rotation) to a radian (its closed form).
TEST(VolumetricJacobian, IsThatOfDualNumbersForEveryChain) {
  std::uint64_t seed = 0;
  for (const Chain& chain : AllCounts()) {
    for (const double angle : {0.0, 1e-6, 1e-3, 1.0}) {
      Numbers numbers(++seed);
      const auto errors = numbers.Errors(0.1, angle);
      const Vector3d position = numbers.Vector(1.0), p_TQ = numbers.Vector(1.0);
      const auto closed = VolumetricErrorAndJacobian(chain, position, p_TQ, errors);
      Eigen::Matrix<double, 3, kInputs> J;
      J << closed.J_error_motions, closed.J_error_squareness, closed.J_error_position,
          closed.J_error_tool;
      // The closed form of the rotation loses up to 3 digits just above its switch at 0.01 rad.
      EXPECT_LT((J - ByJets(chain, position, p_TQ, errors)).cwiseAbs().maxCoeff(), 5e3 * kEps)
          << chain.Text() << " " << angle;
      EXPECT_LT((closed.error - VolumetricError<double>(chain, position, p_TQ, errors)).norm(),
                64 * kEps);
    }
  }
}

TEST(VolumetricJacobian, IsThatOfFiniteDifferences) {
  const double h = 1e-5;  // third derivatives of size 10: h^2 / 6 * 10 and eps / h
  const double tolerance = h * h / 6 * 10 + 16 * kEps / h;
  std::uint64_t seed = 0;
  for (const Chain& chain : AllCounts()) {
    Numbers numbers(++seed);
    const auto errors = numbers.Errors(0.1, 0.3);
    const Vector3d position = numbers.Vector(1.0), p_TQ = numbers.Vector(1.0);
    const auto closed = VolumetricErrorAndJacobian(chain, position, p_TQ, errors);
    for (int i = 0; i < kAxes * kMotions; ++i) {
      const auto at = [&](double step) {
        MotionErrors<double> moved = errors;
        moved.axes[i / kMotions][i % kMotions] += step;
        return VolumetricError<double>(chain, position, p_TQ, moved);
      };
      EXPECT_LT(((at(h) - at(-h)) / (2 * h) - closed.J_error_motions.col(i)).norm(), tolerance);
    }
    for (int i = 0; i < 3; ++i) {
      const auto at = [&](double step) {
        return VolumetricError<double>(chain, position + step * Vector3d::Unit(i), p_TQ, errors);
      };
      EXPECT_LT(((at(h) - at(-h)) / (2 * h) - closed.J_error_position.col(i)).norm(), tolerance);
    }
  }
}

}  // namespace volumetric_jacobian_test
}  // namespace abbe::machine
