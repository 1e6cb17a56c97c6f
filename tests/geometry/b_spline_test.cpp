#include "geometry/b_spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "failure/failure.h"

namespace abbe::geometry {
namespace b_spline_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();

TEST(BSpline, CardinalCubicHasTheKnownValues) {
  const BSplineBasis basis(3, {-3, -2, -1, 0, 1, 2, 3, 4, 5});  // interval [0, 2]
  EXPECT_EQ(basis.a(), 0.0);
  EXPECT_EQ(basis.b(), 2.0);
  const auto value = basis.At(1.0), slope = basis.At(1.0, 1), curvature = basis.At(1.0, 2);
  EXPECT_EQ(value.first, 1);
  const double values[] = {1.0 / 6, 4.0 / 6, 1.0 / 6, 0}, slopes[] = {-0.5, 0, 0.5, 0},
               curvatures[] = {1, -2, 1, 0};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(value.values[i], values[i], 2 * kEps);
    EXPECT_NEAR(slope.values[i], slopes[i], 2 * kEps);
    EXPECT_NEAR(curvature.values[i], curvatures[i], 2 * kEps);
  }
}

// SciPy 1.10.1, python3:
//   from scipy.interpolate import BSpline
//   t = [0,0,0,0,0,.3,.5,.5,.9,1.4,2,2,2,2,2]; c = [1,-2,.5,3,-1,2.5,.25,-.75,1.5,2]
//   s = BSpline(t, c, 4)
//   for x in (0.0, .17, .5, .71, 1.39, 2.0): print(x, ['%.17g' % s(x, k) for k in range(4)])
TEST(BSpline, AgreesWithSciPyOnUnequalAndDoubleKnots) {
  const BSplineBasis basis(4, {0, 0, 0, 0, 0, .3, .5, .5, .9, 1.4, 2, 2, 2, 2, 2});
  Eigen::VectorXd c(10);
  c << 1, -2, .5, 3, -1, 2.5, .25, -.75, 1.5, 2;
  const BSpline spline(basis, c);
  const struct {
    double x, derivatives[4];
  } oracle[] = {
      {0.0, {1, -40, 600, -4000.0000000000009}},
      {0.17, {-0.046502370370370139, 12.643081481481484, 68.995555555555541, -2247.1111111111113}},
      {0.5, {0.39730639730639727, -7.6094276094276099, 152.52525252525251, -1074.7474747474746}},
      {0.71, {0.75246659932659932, 5.4623299663299676, -5.4626262626262498, -429.89898989899007}},
      {1.39, {0.11830776219495232, -1.3212449564515698, 16.656983053677266, 43.910176141581104}},
      {2.0, {2, 3.3333333333333321, -24.242424242424235, -179.43067033976121}},
  };
  double scale =
      3.0;  // largest coefficient; each derivative is a difference over a span of 0.3 / 4
  for (int k = 0; k < 4; ++k, scale *= 2 * 4 / 0.3) {
    for (const auto& at : oracle) {
      EXPECT_NEAR(spline.Value(at.x, k), at.derivatives[k], 64 * kEps * scale) << at.x << ", " << k;
    }
  }
}

TEST(BSpline, ReproducesPolynomialsUpToItsDegree) {
  // The blossom of x^n: coefficient i is the mean of all products of n of the `degree` inner knots.
  for (int degree = 1; degree <= 6; ++degree) {
    const auto basis = BSplineBasis::Uniform(degree, -0.5, 1.5, degree + 6);
    for (int power = 0; power <= degree; ++power) {
      Eigen::VectorXd c(basis.size());
      for (int i = 0; i < basis.size(); ++i) {
        std::vector<double> symmetric(power + 1, 0.0);  // elementary symmetric functions
        symmetric[0] = 1.0;
        for (int j = 1; j <= degree; ++j) {
          for (int k = power; k >= 1; --k) symmetric[k] += basis.knots()[i + j] * symmetric[k - 1];
        }
        double binomial = 1.0;
        for (int k = 1; k <= power; ++k) binomial *= static_cast<double>(degree - power + k) / k;
        c[i] = symmetric[power] / binomial;
      }
      const BSpline spline(basis, c);
      for (const double x : {-0.5, -0.31, 0.0, 0.77, 1.5}) {
        EXPECT_NEAR(spline.Value(x), std::pow(x, power), 64 * kEps * std::pow(1.5, power));
      }
      if (power == 1) {
        EXPECT_LT((c - basis.LineCoefficients()).norm(), 16 * kEps);
      }
    }
  }
}

TEST(BSpline, EndCoefficientsAreEndValues) {
  const auto basis = BSplineBasis::Uniform(3, 0.0, 0.06, 9);
  EXPECT_EQ(basis.Row(0.0)[0], 1.0);
  EXPECT_EQ(basis.Row(0.06)[8], 1.0);
}

TEST(BSpline, DegreeZeroIsAStaircaseAndItsDerivativeIsZero) {
  const BSpline stairs(BSplineBasis(0, {0, 1, 2, 3}), Eigen::Vector3d(5, -1, 2));
  EXPECT_EQ(stairs.Value(0.99), 5);
  EXPECT_EQ(stairs.Value(1.0), -1);  // the span to the right
  EXPECT_EQ(stairs.Value(3.0), 2);   // at b the span to the left
  EXPECT_EQ(stairs.Value(1.5, 1), 0);
}

TEST(BSpline, RefusesToExtrapolate) {
  const auto basis = BSplineBasis::Uniform(3, 0.0, 0.06, 9);
  EXPECT_THROW(basis.At(-1e-9), InputError);
  EXPECT_THROW(basis.At(0.06 + 1e-9), InputError);
  EXPECT_THROW(basis.At(std::numeric_limits<double>::quiet_NaN()), InputError);
  EXPECT_EQ(basis.Row(0.06 * (1 + kEps))[8], 1.0);  // rounding of a station's position
}

TEST(BSpline, RefusesBadBases) {
  EXPECT_THROW(BSplineBasis::Uniform(3, 0, 1, 3), InputError);
  EXPECT_THROW(BSplineBasis::Uniform(3, 1, 1, 8), InputError);
  EXPECT_THROW(BSplineBasis::Uniform(-1, 0, 1, 8), InputError);
  EXPECT_THROW(BSplineBasis::Uniform(16, 0, 1, 40), InputError);
  EXPECT_THROW(BSplineBasis(2, {0, 0, 0, 2, 1, 3, 3, 3}), InputError);     // decreasing
  EXPECT_THROW(BSplineBasis(2, {0, 0, 0, 1, 1, 1, 3, 3, 3}), InputError);  // torn apart at 1
  EXPECT_NO_THROW(BSplineBasis(2, {0, 0, 0, 1, 1, 3, 3, 3}));              // a kink at 1
  EXPECT_THROW(BSplineBasis(2, {0, 0, 0, 0, 1, 3, 3, 3}), InputError);     // empty function
  EXPECT_THROW(BSpline(BSplineBasis::Uniform(1, 0, 1, 2), Eigen::Vector3d(1, 2, 3)), InputError);
  EXPECT_THROW(BSplineBasis::Uniform(0, 0, 1, 2).LineCoefficients(), InputError);
}

}  // namespace b_spline_test
}  // namespace abbe::geometry
