#include "rig/course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace abbe::rig {
namespace course_test {

using Eigen::Vector3d;

constexpr CourseRun::Dynamics kDynamics{0.2, 0.015};
constexpr double kStep = 1e-3;

std::vector<CourseState> Counted(const Course& course) {
  std::vector<CourseState> states;
  CourseRun run(course, kDynamics, kStep);
  while (run.Next()) {
    if (run.state().counts) states.push_back(run.state());
  }
  return states;
}

TEST(Course, NeverExceedsFeedNorAccelerationAlongALine) {
  const Course course = LineCourse({{0, 0, 0}, {0.02, 0, 0}, {0.02, 0.0004, 0}}, 0.01, 0.1, 1);
  CourseRun run(course, kDynamics, kStep);
  Vector3d before = Vector3d::Zero();
  double fastest = 0.0;
  while (run.Next()) {
    const Vector3d& speed = run.state().velocity;
    // A difference quotient of positions rounded to 3e-18 m over 1 ms.
    ASSERT_LE(speed.norm(), 0.01 + 1e-14) << run.state().time;
    ASSERT_LE((speed - before).norm() / kStep, 0.2 + 1e-10) << run.state().time;
    before = speed;
    fastest = std::max(fastest, speed.norm());
  }
  EXPECT_NEAR(fastest, 0.01, 1e-14);
}

// A first-order lag follows a circle with the radius r / sqrt(1 + (w lag)^2).
TEST(Course, FollowsACircleInsideItsRadius) {
  constexpr double kRadius = 0.02, kFeed = 0.02;
  const auto states = Counted(CircleCourse({'Z', {0.03, 0.03, 0.03}, kRadius, kFeed}));
  const double omega_lag = kFeed / kRadius * kDynamics.lag;
  for (const CourseState& state : states) {
    const double radius = std::hypot(state.position.x() - 0.03, state.position.y() - 0.03);
    // Taken straight within a step: w^2 step^2 / 8 of the radius.
    ASSERT_NEAR(radius, kRadius / std::sqrt(1.0 + omega_lag * omega_lag), kRadius * 1.3e-7);
    ASSERT_DOUBLE_EQ(state.position.z(), 0.03);
  }
}

TEST(Course, RecordsOneFullTurnOfEachSenseInEveryPlane) {
  for (const char normal : {'X', 'Y', 'Z'}) {
    const int first = (normal - 'X' + 1) % 3, second = (first + 1) % 3;
    double turned[2] = {0.0, 0.0};
    CourseState before{};
    for (const CourseState& state : Counted(CircleCourse({normal, Vector3d::Zero(), 0.01, 0.01}))) {
      if (before.direction == state.direction) {
        const Vector3d &a = before.command, &b = state.command;
        turned[state.direction > 0 ? 0 : 1] +=
            std::atan2(a[first] * b[second] - a[second] * b[first],
                       a[first] * b[first] + a[second] * b[second]);
      }
      before = state;
    }
    // Up to a row less at each end.
    const double row = 0.01 * kStep / 0.01;
    EXPECT_NEAR(turned[0], 2.0 * std::numbers::pi, 2.0 * row);
    EXPECT_NEAR(turned[1], -2.0 * std::numbers::pi, 2.0 * row);
  }
}

TEST(Course, StandsAtEveryPlaceForItsDwell) {
  const auto places = GridPlaces({0.03, 0.03, 0.03}, {0.02, 0.02, 0.01}, {3, 2, 2});
  ASSERT_EQ(places.size(), 12U);
  std::vector<int> rows(places.size(), 0);
  for (const CourseState& state : Counted(DwellCourse(places, 0.01, 0.2, 1))) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      if ((state.position - places[i]).norm() < 1e-7) ++rows[i];
    }
  }
  for (const int each : rows) EXPECT_GE(each, 199);
}

TEST(Course, AGridGoesFromNeighbourToNeighbour) {
  const auto places = GridPlaces({0.0, 0.0, 0.0}, {2.0, 3.0, 1.0}, {3, 4, 2});
  ASSERT_EQ(places.size(), 24U);
  for (std::size_t i = 1; i < places.size(); ++i) {
    EXPECT_DOUBLE_EQ((places[i] - places[i - 1]).norm(), 1.0) << i;
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((places[i] - places[j]).norm(), 0.5);
  }
}

TEST(Course, TheSquareHasFourSidesInEachSense) {
  const auto states = Counted(SquareCourse({'Y', {0.03, 0.03, 0.03}, 0.02, 0.01, 2}));
  double area[2] = {0.0, 0.0};
  CourseState before = states.front();
  for (const CourseState& state : states) {
    const Vector3d a = before.command - Vector3d::Constant(0.03);
    const Vector3d b = state.command - Vector3d::Constant(0.03);
    if (before.direction == state.direction) {
      area[state.direction > 0 ? 0 : 1] += 0.5 * (a.z() * b.x() - a.x() * b.z());
    }
    EXPECT_NEAR(std::max(std::abs(a.x()), std::abs(a.z())), 0.01, 1e-12);
    before = state;
  }
  // Twice the square; the first row of a pass misses a step's worth of sector.
  EXPECT_NEAR(area[0], 2.0 * 4e-4, 1e-6);
  EXPECT_NEAR(area[1], -2.0 * 4e-4, 1e-6);
}

TEST(Course, SteppingVisitsEachStopOfEachAxisThereAndBack) {
  const auto places = SteppingPlaces({0.01, 0.01, 0.01}, 0.005, 5);
  ASSERT_EQ(places.size(), 31U);
  EXPECT_EQ(places.front(), places.back());
  EXPECT_DOUBLE_EQ(places[5].x(), 0.035);
  EXPECT_DOUBLE_EQ(places[15].y(), 0.035);
  EXPECT_DOUBLE_EQ(places[25].z(), 0.035);
  EXPECT_DOUBLE_EQ(places[10].x(), 0.01);
}

}  // namespace course_test
}  // namespace abbe::rig
