#include "standards/circularity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "failure/failure.h"

namespace abbe::standards {
namespace circularity_test {

constexpr double kRadius = 0.05;
constexpr double kRounding = 1e-15;

PlanePath Path(const std::function<double(double)>& r, double cx = 0.0, double cy = 0.0) {
  PlanePath path;
  for (int degree = 0; degree < 360; ++degree) {
    const double t = degree * std::numbers::pi / 180.0;
    path.x.push_back(cx + r(t) * std::cos(t));
    path.y.push_back(cy + r(t) * std::sin(t));
  }
  return path;
}

TEST(Circularity, SensesOfDifferentRadius) {
  const auto figures = EvaluateCircularity({.radius = kRadius,
                                            .cw = Path([](double) { return kRadius - 1e-6; }),
                                            .ccw = Path([](double) { return kRadius + 3e-6; })});
  EXPECT_NEAR(figures.cw->G, 0.0, kRounding);
  EXPECT_NEAR(figures.ccw->G, 0.0, kRounding);
  EXPECT_NEAR(figures.both->G, 4e-6, kRounding);
  EXPECT_NEAR(figures.F_max, 3e-6, kRounding);
  EXPECT_NEAR(figures.F_min, -1e-6, kRounding);
  EXPECT_NEAR(*figures.D, 1e-6, kRounding);
  EXPECT_NEAR(figures.cw->F_max, -1e-6, kRounding);
}

// Radius and centring are no circular deviation: G is zero, F tells both.
TEST(Circularity, AnOffCentreCircleHasNoGButAnF) {
  constexpr double e = 5e-6;
  const auto figures = EvaluateCircularity(
      {.radius = kRadius, .cw = {}, .ccw = Path([](double) { return kRadius; }, e, 0.0)});
  EXPECT_NEAR(figures.ccw->G, 0.0, kRounding);
  EXPECT_NEAR(figures.F_max, e, kRounding);
  EXPECT_NEAR(figures.F_min, -e, kRounding);
  EXPECT_NEAR(figures.F_max_ls, 0.0, kRounding);
  EXPECT_FALSE(figures.cw || figures.both || figures.D);
}

// A servo mismatch: the oval of one sense is the other's turned by 90 degrees.
TEST(Circularity, OvalsThatTurnWithTheSense) {
  constexpr double a = 4e-6;
  const auto oval = [](double sense) {
    return Path([=](double t) { return kRadius + sense * a * std::sin(2 * t); });
  };
  const auto figures = EvaluateCircularity({.radius = kRadius, .cw = oval(-1), .ccw = oval(1)});
  constexpr double kSecondOrder = a * a / kRadius;
  for (const auto& sense : {figures.cw, figures.ccw, figures.both}) {
    EXPECT_NEAR(sense->G, 2 * a, kSecondOrder);
    EXPECT_NEAR(sense->G_ls, 2 * a, kSecondOrder);
  }
  EXPECT_NEAR(*figures.D, 0.0, kSecondOrder);
}

// Points that are lost and points at rest leave the least-squares figures where those of the even
// path are: to the curvature of the oval over the gaps, where equal weights give 8 % more.
TEST(Circularity, FollowsThePathAndNotTheDensityOfItsPoints) {
  constexpr double a = 4e-6;
  const PlanePath even = Path([](double t) { return kRadius + a * std::sin(2 * t); }, 1e-6);
  PlanePath uneven;
  for (std::size_t i = 0; i < 360;) {
    for (int rest = 0; rest < (i == 0 ? 100 : 1); ++rest) {
      uneven.x.push_back(even.x[i]);
      uneven.y.push_back(even.y[i]);
    }
    i += i < 90 ? 1 : i < 180 ? 9 : i < 225 ? 2 : 5;
  }
  const auto figures = EvaluateCircularity({.radius = kRadius, .cw = even, .ccw = uneven});
  EXPECT_NEAR(figures.cw->G_ls, 2 * a, 1e-3 * a);
  EXPECT_NEAR(figures.ccw->G_ls, figures.cw->G_ls, 0.01 * a);
  EXPECT_NEAR(figures.ccw->least_squares.x, 1e-6, 0.01 * a);
  EXPECT_NEAR(figures.both->least_squares.radius, kRadius, 0.01 * a);
  const Roundness unweighted = EvaluateRoundness(CircleKind::kLeastSquares, uneven.x, uneven.y);
  EXPECT_GT(unweighted.Error(), 1.08 * figures.cw->G_ls);
}

// What one turn lacks another gives. Gaps of 30 degrees; each turn by itself would be off by 4 %.
TEST(Circularity, TakesFromOneTurnWhatAnotherLacks) {
  constexpr double a = 4e-6;
  const PlanePath even = Path([](double t) { return kRadius + a * std::sin(2 * t); }, 1e-6);
  PlanePath turns;
  for (const std::size_t gap : {30U, 200U}) {
    for (std::size_t i = 0; i < 360; ++i) {
      if (i >= gap && i < gap + 30) continue;
      turns.x.push_back(even.x[i]);
      turns.y.push_back(even.y[i]);
    }
  }
  const auto figures = EvaluateCircularity({.radius = kRadius, .cw = even, .ccw = turns});
  EXPECT_NEAR(figures.ccw->G_ls, figures.cw->G_ls, 1e-3 * a);
  EXPECT_NEAR(figures.ccw->least_squares.x, figures.cw->least_squares.x, 1e-3 * a);
  EXPECT_NEAR(figures.ccw->least_squares.y, figures.cw->least_squares.y, 1e-3 * a);
}

TEST(Circularity, RefusesWhatCannotBeJudged) {
  EXPECT_THROW(EvaluateCircularity({.radius = kRadius, .cw = {}, .ccw = {}}), InputError);
  EXPECT_THROW(EvaluateCircularity({.radius = 0.0, .cw = {}, .ccw = {{0, 1, 0}, {0, 0, 1}}}),
               InputError);
  try {
    EvaluateCircularity({.radius = 1.0, .cw = {{0, 1}, {0, 1}}, .ccw = {}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("clockwise: ", 0), 0U) << error.what();
  }
}

}  // namespace circularity_test
}  // namespace abbe::standards
