#include "paths/square_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "tests/paths/hand_made_path.h"

namespace abbe::paths {
namespace square_path_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kSide = 0.05;
constexpr double kRounding = 1e-14;  // m, and rad by a side of 50 mm: 2e-13

std::vector<Vector3d> Square(const Vector3d& first, const Vector3d& second) {
  const Vector3d corner = Vector3d::Constant(0.005);
  const std::vector<Vector3d> corners{corner, corner + kSide * first,
                                      corner + kSide * (first + second), corner + kSide * second};
  std::vector<Vector3d> path;
  for (std::size_t i = 0; i < 4; ++i) Go(path, corners[i], corners[(i + 1) % 4], 1000);
  return path;
}

std::vector<Vector3d> SquareXY() { return Square(Vector3d::UnitX(), Vector3d::UnitY()); }

TEST(SquarePath, APerfectOneHasNoErrorInAnyPlane) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  for (const auto& [path, plane] :
       {std::pair{Square(x, y), "XY"}, {Square(y, z), "YZ"}, {Square(z, x), "XZ"}}) {
    const SquareFigures figures =
        EvaluateSquare(HandMade(path, [](const Vector3d& p) { return p; }));
    EXPECT_EQ(figures.plane, plane);
    for (const SquareSide& side : figures.sides) {
      EXPECT_NEAR(side.length, kSide, kRounding);
      EXPECT_NEAR(side.nominal, kSide, kRounding);
      EXPECT_LT(side.minimum_zone.error, kRounding);
    }
    for (const double corner : figures.corners) EXPECT_LT(std::abs(corner), 1e-12);
  }
}

// x grows by 80 ppm, and by 150 urad of y less: the corner at the origin is 90 degrees + 150 urad.
TEST(SquarePath, ScaleAndSquareness) {
  constexpr double kScale = 80e-6, kOut = 150e-6;
  const SquareFigures figures =
      EvaluateSquare(HandMade(SquareXY(), [](const Vector3d& p) -> Vector3d {
        return {p.x() * (1.0 + kScale) - kOut * p.y() + 4e-4, p.y(), p.z()};
      }));
  for (std::size_t i = 0; i < 4; ++i) {
    const SquareSide& side = figures.sides[i];
    EXPECT_EQ(side.axis, i % 2 == 0 ? 'X' : 'Y');
    // The sides along Y lean by 150 urad: longer by half of its square, 0.6 nm.
    const double expected = i % 2 == 0 ? kScale * kSide : kOut * kOut * kSide / 2.0;
    EXPECT_NEAR(side.length - side.nominal, expected, 1e-12);
    EXPECT_NEAR(figures.corners[i], i % 2 == 0 ? -kOut : kOut, kOut * kScale);
    EXPECT_LT(side.least_squares.error, kRounding);
  }
}

// The lower side sags like a parabola of height h over its full length. Judged are pieces from 2 %
// on, the first with its mean at 2.5 %, up to the row at 98 %: of the parabola ((95 + 96) / 2 %)^2
// of h.
TEST(SquarePath, ABowIsTheStraightnessOfItsSide) {
  constexpr double kHeight = 3e-6;
  const SquareFigures figures =
      EvaluateSquare(HandMade(SquareXY(), [](const Vector3d& p) -> Vector3d {
        const double part = (p.x() - 0.005 - kSide / 2.0) / (kSide / 2.0);
        return {p.x(), p.y() + (p.y() == 0.005 ? kHeight * part * part : 0.0), p.z()};
      }));
  EXPECT_NEAR(figures.sides[0].minimum_zone.error, kHeight * 0.955 * 0.955, 0.002 * kHeight);
  EXPECT_LE(figures.sides[0].minimum_zone.error, figures.sides[0].least_squares.error + kRounding);
  EXPECT_LT(figures.sides[2].minimum_zone.error, kRounding);
}

TEST(SquarePath, RefusesWhatIsNoSquare) {
  const auto refusal = [](const std::vector<Vector3d>& path) -> std::string {
    try {
      EvaluateSquare(HandMade(path, [](const Vector3d& p) { return p; }));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  std::vector<Vector3d> open = SquareXY();
  open.resize(3000);  // without its last side
  EXPECT_THAT(refusal(open), HasSubstr("made.csv: 0 pieces of the side along Y at X = 5.000 mm"));
  std::vector<Vector3d> circle;
  circle.reserve(720);
  for (int i = 0; i < 720; ++i) {
    circle.emplace_back(0.02 * std::cos(i * 0.00873), 0.02 * std::sin(i * 0.00873), 0.0);
  }
  EXPECT_THAT(refusal(circle), HasSubstr("% of the rows lie on the sides"));
  std::vector<Vector3d> line;
  Go(line, Vector3d::Zero(), Vector3d::Constant(0.01), 100);
  EXPECT_THAT(refusal(line), HasSubstr("made.csv: the commanded path fills"));
}

}  // namespace square_path_test
}  // namespace abbe::paths
