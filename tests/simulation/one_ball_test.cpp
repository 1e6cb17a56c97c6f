#include "simulation/linkage/one_ball.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "failure/failure.h"

namespace abbe::simulation {
namespace one_ball_test {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

// A spherical wrist 0.3 m from the base, turned by three angles, with a ball at its end; the
// instrument sees it with an error of its own.
LinkageRun HandOfBall(const char* name, const Vector3d& ball, double first_angle = 0.0) {
  LinkageRun run;
  run.name = name;
  run.reference.resize(3, 40);
  run.readings.angles.resize(3, 40);
  for (Eigen::Index i = 0; i < 40; ++i) {
    const auto k = static_cast<double>(i);
    const Vector3d q(first_angle + 0.9 * std::sin(k), 0.7 * std::cos(1.3 * k),
                     1.1 * std::sin(0.7 * k));
    run.readings.angles.col(i) = q;
    const auto hand = AngleAxisd(q[0], Vector3d::UnitZ()) * Eigen::Translation3d(0.3, 0.0, 0.0) *
                      AngleAxisd(q[1], Vector3d::UnitY()) * AngleAxisd(q[2], Vector3d::UnitX());
    run.reference.col(i) = hand * ball + 5e-6 * Vector3d(std::sin(7 * k), std::cos(9 * k), 0.0);
  }
  run.commanded = run.reference;
  run.reference_sd = Eigen::Matrix3Xd::Constant(3, 40, 5e-6);
  return run;
}

std::string RefusalOf(const std::vector<LinkageRun>& runs,
                      const std::vector<std::string>& balls = {}) {
  OneBall ball("give one");
  try {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      recording::Recording recording{runs[i].name, "kind = \"linkage\"\n", {}, {}};
      if (i < balls.size()) recording.header += "mounting = { ball = \"" + balls[i] + "\" }\n";
      ball.Add(recording, runs[i]);
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const Vector3d kOne(0.02, 0.01, 0.10), kOther(0.02, -0.03, 0.09);

TEST(OneBall, RefusesAnotherBallAtTheSameAngles) {
  EXPECT_THAT(RefusalOf({HandOfBall("a.csv", kOne), HandOfBall("b.csv", kOther)}),
              testing::AllOf(testing::HasSubstr("b.csv"), testing::HasSubstr("a.csv"),
                             testing::HasSubstr("two balls")));
  EXPECT_EQ(RefusalOf({HandOfBall("a.csv", kOne), HandOfBall("b.csv", kOne)}), "");
}

// An instrument that was moved keeps all distances; gross readings are not the usual ones.
TEST(OneBall, TakesAMovedBaseAndGrossReadings) {
  LinkageRun moved = HandOfBall("b.csv", kOne);
  const auto X = Eigen::Translation3d(0.4, -0.2, 0.1) * AngleAxisd(1.0, Vector3d(0.6, 0.0, 0.8));
  for (Eigen::Index i = 0; i < moved.poses(); ++i) {
    moved.reference.col(i) = X * Vector3d(moved.reference.col(i));
  }
  for (const Eigen::Index i : {3, 17, 30}) moved.reference.col(i).setZero();
  EXPECT_EQ(RefusalOf({HandOfBall("a.csv", kOne), moved}), "");
}

TEST(OneBall, KeepsToWhatIsStated) {
  LinkageRun one = HandOfBall("a.csv", kOne), other = HandOfBall("b.csv", kOther, 1.0);
  EXPECT_EQ(RefusalOf({one, other}), "");  // no angles in common: nothing tells
  EXPECT_EQ(RefusalOf({one, other}, {"SMR 1"}), "");
  EXPECT_EQ(RefusalOf({one, other}, {"SMR 1", "SMR 1"}), "");
  EXPECT_THAT(RefusalOf({one, other}, {"SMR 1", "SMR 2"}),
              testing::HasSubstr("mounting.ball is \"SMR 2\""));
  other = HandOfBall("b.csv", kOther);
  other.mounting = "second";
  EXPECT_EQ(RefusalOf({one, other}), "");
}

// Angles that are not filled in, or one pose many times, say nothing.
TEST(OneBall, LooksForPosesThatDiffer) {
  LinkageRun one = HandOfBall("a.csv", kOne), other = HandOfBall("b.csv", kOther);
  one.readings.angles.setZero();
  other.readings.angles.setZero();
  EXPECT_EQ(RefusalOf({one, other}), "");
}

}  // namespace one_ball_test
}  // namespace abbe::simulation
