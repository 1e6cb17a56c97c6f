#include "standards/circle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "failure/failure.h"

namespace abbe::standards {
namespace circle_test {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.01;
// Coordinates of 10 mm keep their last bit at 2e-18 m; a fit of hundreds of points, some of it.
constexpr double kRounding = 1e-15;
constexpr CircleKind kKinds[] = {CircleKind::kLeastSquares, CircleKind::kMinimumZone};

struct Points {
  std::vector<double> x, y;
};

// 360 points of r(t) about (cx, cy); whole degrees, so peaks at multiples of 1 degree are met.
Points Polar(const std::function<double(double)>& r, double cx = 0.0, double cy = 0.0) {
  Points points;
  for (int degree = 0; degree < 360; ++degree) {
    const double t = degree * kPi / 180.0;
    points.x.push_back(cx + r(t) * std::cos(t));
    points.y.push_back(cy + r(t) * std::sin(t));
  }
  return points;
}

TEST(Circle, FindsACircleWhereverItStands) {
  const Points points = Polar([](double) { return kRadius; }, 0.123, -0.456);
  for (const CircleKind kind : kKinds) {
    const Roundness found = EvaluateRoundness(kind, points.x, points.y);
    EXPECT_NEAR(found.circle.x, 0.123, kRounding);
    EXPECT_NEAR(found.circle.y, -0.456, kRounding);
    EXPECT_NEAR(found.circle.radius, kRadius, kRounding);
    EXPECT_NEAR(found.Error(), 0.0, 4 * kRounding);
  }
}

// Lobes of order 2 and more, evenly sampled, leave both centres where they are: the sums with cos t
// and sin t vanish, and four or more extremes alternate around.
TEST(Circle, LobesKeepTheCentreAndGiveTheirHeight) {
  constexpr double kHeight = 3e-6;
  for (const int lobes : {2, 3, 4, 5, 9}) {
    const Points points =
        Polar([=](double t) { return kRadius + kHeight * std::cos(lobes * t); }, 0.02, 0.03);
    for (const CircleKind kind : kKinds) {
      const Roundness found = EvaluateRoundness(kind, points.x, points.y);
      // Second order: the LS centre of a path with deviation h moves by less than h^2 / R.
      constexpr double kSecondOrder = kHeight * kHeight / kRadius;
      EXPECT_NEAR(found.circle.x, 0.02, kSecondOrder) << lobes;
      EXPECT_NEAR(found.circle.y, 0.03, kSecondOrder) << lobes;
      // An odd number of lobes has its valleys between whole degrees, at most half a degree off.
      const double missed = kHeight * std::pow(lobes * kPi / 360.0, 2) / 2.0 + kSecondOrder;
      EXPECT_NEAR(found.Error(), 2 * kHeight, missed) << lobes;
      EXPECT_NEAR(found.rms, kHeight / std::sqrt(2.0), missed) << lobes;
    }
  }
}

TEST(Circle, AnEllipseIsAsWideAsItsHalfAxesDiffer) {
  Points ellipse;
  for (int degree = 0; degree < 360; ++degree) {
    const double t = degree * kPi / 180.0;
    ellipse.x.push_back(0.0101 * std::cos(t));
    ellipse.y.push_back(0.0099 * std::sin(t));
  }
  for (const CircleKind kind : kKinds) {
    const Roundness found = EvaluateRoundness(kind, ellipse.x, ellipse.y);
    EXPECT_NEAR(found.Error(), 0.0002, kRounding);
    EXPECT_NEAR(found.circle.x, 0.0, kRounding);
  }
}

// One point stands out by h at t = 0 of an otherwise perfect circle of four points a quarter turn
// apart. Moving the centre by h/2 towards it leaves r = R + h/2 at 0 and R + h/2 at 180 degrees, R
// at 90 and 270 to first order: zone h/2. About the LS centre (shift h/2 as well: sum of cos^2 is
// 2, so h cos 0 / 2) the same; so the LS figure here is h/2 too, from the closed form.
TEST(Circle, OnePointThatStandsOutIsHalvedByTheCentre) {
  constexpr double h = 1e-6;
  const std::vector<double> x{kRadius + h, 0, -kRadius, 0}, y{0, kRadius, 0, -kRadius};
  for (const CircleKind kind : kKinds) {
    const Roundness found = EvaluateRoundness(kind, x, y);
    EXPECT_NEAR(found.Error(), h / 2, h * h / kRadius);
    EXPECT_NEAR(found.circle.x, h / 2, h * h / kRadius);
  }
}

// A bump on one point of many: least squares hardly moves (2h/n), the minimum zone moves to where
// the neighbours' rise -c cos t of the far side meets the bump: at best h/2 wide.
TEST(Circle, MinimumZoneBeatsLeastSquaresOnABump) {
  constexpr double h = 2e-6;
  const Points points = Polar([](double t) { return kRadius + (t == 0.0 ? h : 0.0); });
  const Roundness squares = EvaluateRoundness(CircleKind::kLeastSquares, points.x, points.y);
  const Roundness zone = EvaluateRoundness(CircleKind::kMinimumZone, points.x, points.y);
  EXPECT_NEAR(squares.circle.x, 2 * h / 360, h * h / kRadius);
  EXPECT_NEAR(squares.Error(), h * (1 - 2.0 / 360 - 1.0 / 360) + h * 3.0 / 360, h * 2.0 / 360);
  EXPECT_LT(zone.Error(), squares.Error());
}

TEST(Circle, FitsAnArc) {
  Points arc;
  for (int degree = 20; degree <= 80; ++degree) {
    arc.x.push_back(1.0 + kRadius * std::cos(degree * kPi / 180));
    arc.y.push_back(2.0 + kRadius * std::sin(degree * kPi / 180));
  }
  for (const CircleKind kind : kKinds) {
    const Circle circle = ReferenceCircle(kind, arc.x, arc.y);
    // Rounding of 1 m + 10 mm (2e-16) grows by the sagitta of 60 degrees: R / (R - R cos 30) = 7.5,
    // squared for the centre along the chord's normal.
    EXPECT_NEAR(circle.x, 1.0, 1e-13);
    EXPECT_NEAR(circle.radius, kRadius, 1e-13);
  }
}

TEST(Circle, RefusesWhatIsNoCircle) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const CircleKind kind : kKinds) {
    EXPECT_THROW(ReferenceCircle(kind, std::vector{0., 1.}, std::vector{0., 1.}), InputError);
    EXPECT_THROW(ReferenceCircle(kind, std::vector{0., 1., 2.}, std::vector{0., 1.}), InputError);
    EXPECT_THROW(ReferenceCircle(kind, std::vector{0., 1., 2.}, std::vector{0., 1., 2.}),
                 InputError);
    EXPECT_THROW(ReferenceCircle(kind, std::vector{1., 1., 1.}, std::vector{2., 2., 2.}),
                 InputError);
    EXPECT_THROW(ReferenceCircle(kind, std::vector{0., 1., nan}, std::vector{0., 1., 3.}),
                 InputError);
  }
}

}  // namespace circle_test
}  // namespace abbe::standards
