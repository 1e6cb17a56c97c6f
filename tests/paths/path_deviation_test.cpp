#include "paths/path_deviation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "failure/failure.h"
#include "geometry/rotation.h"
#include "tests/paths/hand_made_path.h"

namespace abbe::paths {
namespace path_deviation_test {

using Eigen::Vector3d;

constexpr double kRounding = 1e-15;  // m

std::vector<Vector3d> Corner() {
  std::vector<Vector3d> path;
  Go(path, {0.0, 0.0, 0.0}, {0.02, 0.0, 0.0}, 200);
  Go(path, {0.02, 0.0, 0.0}, {0.02, 0.03, 0.0}, 300);
  path.emplace_back(0.02, 0.03, 0.0);
  return path;
}

TEST(PathDeviation, WhatIsLateAlongTheWayDoesNotCount) {
  // 1 um above the path, and 50 um late along x.
  const auto path = HandMade(Corner(), [](const Vector3d& p) -> Vector3d {
    return p + Vector3d(p.y() == 0.0 && p.x() > 1e-3 ? -50e-6 : 0.0, 0.0, 1e-6);
  });
  const PathDeviation found = DeviationFrom(path, {});
  EXPECT_NEAR(found.length, 0.05, kRounding);
  // Where the path turns up, late rows are still on its first leg.
  EXPECT_NEAR(found.rms, 1e-6, kRounding);
  EXPECT_NEAR(found.largest, 1e-6, kRounding);
  EXPECT_NEAR(found.along[100], 0.01 - 50e-6, kRounding);
}

TEST(PathDeviation, AlignmentTakesAwayHowTheInstrumentStands) {
  const Eigen::Matrix3d R = geometry::ExpRotation<double>(Vector3d(0.3, -0.2, 0.5));
  const Vector3d p0(0.1, 0.2, -0.3);
  const auto path = HandMade(Corner(), [&](const Vector3d& p) -> Vector3d { return R * p + p0; });
  EXPECT_GT(DeviationFrom(path, {}).largest, 0.1);
  EXPECT_LT(DeviationFrom(path, {.align = true}).largest, 1e-14);
  const auto X = RigidMotion(path.commanded, path.measured);
  EXPECT_LT((X.R - R).norm() + (X.p - p0).norm(), 1e-13);
}

// A path that all lies in one plane must not be aligned by a reflection.
TEST(PathDeviation, AlignmentIsNoReflection) {
  const auto path = HandMade(Corner(), [](const Vector3d& p) -> Vector3d {
    return {p.x(), p.y(), -p.z() + (p.x() > 0.015 ? 1e-6 : 0.0)};
  });
  EXPECT_NEAR(RigidMotion(path.measured, path.commanded).R.determinant(), 1.0, 1e-12);
}

// Round a square and back: its first corner is passed four times, and a search that begins at the
// wrong passage must find back.
TEST(PathDeviation, APathThatCrossesItselfIsFollowed) {
  std::vector<Vector3d> path;
  const std::array<Vector3d, 5> corners{Vector3d(0.0, 0.0, 0.0), Vector3d(0.04, 0.0, 0.0),
                                        Vector3d(0.04, 0.04, 0.0), Vector3d(0.0, 0.04, 0.0),
                                        Vector3d(0.0, 0.0, 0.0)};
  for (std::size_t i = 0; i < 4; ++i) Go(path, corners[i], corners[i + 1], 400);
  for (std::size_t i = 4; i > 0; --i) Go(path, corners[i], corners[i - 1], 400);
  for (const double off : {-2e-6, 2e-6}) {
    const auto seen = HandMade(
        path, [off](const Vector3d& p) -> Vector3d { return p + Vector3d(off, off, 1e-6); });
    // Beside a side by 2 um and 1 um above, or over the end of the square by as much more.
    EXPECT_LE(DeviationFrom(seen, {}).largest, 3e-6 + kRounding);
    EXPECT_LE(DeviationFrom(seen, {.align = true}).largest, 1e-12);
  }
}

TEST(PathDeviation, OfANominalPathOfItsOwn) {
  Eigen::Matrix3Xd nominal(3, 2);
  nominal << 0.0, 1.0, 0.0, 0.0, 3e-6, 3e-6;
  std::vector<Vector3d> line;
  Go(line, {0.0, 4e-6, 0.0}, {0.1, 4e-6, 0.0}, 50);
  const PathDeviation found =
      DeviationFrom(HandMade(line, [](const Vector3d& p) { return p; }), {nominal, false});
  EXPECT_NEAR(found.largest, 5e-6, kRounding);  // 4 um beside, 3 um below
  EXPECT_LT((found.deviation.col(7) - Vector3d(0.0, 4e-6, -3e-6)).norm(), kRounding);
  nominal.col(1) = nominal.col(0);
  EXPECT_THROW(DeviationFrom(HandMade(line, [](const Vector3d& p) { return p; }), {nominal, false}),
               InputError);
}

}  // namespace path_deviation_test
}  // namespace abbe::paths
