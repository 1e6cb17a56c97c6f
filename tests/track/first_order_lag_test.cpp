// The lag against its differential equation, solved in small steps.
#include "track/first_order_lag.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe::track {
namespace first_order_lag_test {

TEST(FirstOrderLag, FollowsAStepAsAnExponential) {
  // A step at once: from 20 to 30, then constant for two lags.
  EXPECT_NEAR(LagAfter(20.0, 30.0, 30.0, 200.0, 100.0), 30.0 - 10.0 * std::exp(-2.0), 1e-12);
}

TEST(FirstOrderLag, FollowsALineAsItsEquationDoes) {
  const double from = 21.0, to = 27.0, seconds = 900.0, lag = 400.0;
  constexpr int kSteps = 200000;
  double y = 19.0;
  for (int i = 0; i < kSteps; ++i) {  // the midpoint rule: error 1e-9
    const double h = seconds / kSteps;
    const double middle = from + (to - from) * (i + 0.5) / kSteps;
    const double slope = (middle - (y + 0.5 * h * (middle - y) / lag)) / lag;
    y += h * slope;
  }
  EXPECT_NEAR(LagAfter(19.0, from, to, seconds, lag), y, 1e-6);
}

TEST(FirstOrderLag, InTwoPartsIsTheSameAsInOne) {
  const double half = LagAfter(18.0, 20.0, 23.0, 300.0, 700.0);
  EXPECT_NEAR(LagAfter(half, 23.0, 26.0, 300.0, 700.0), LagAfter(18.0, 20.0, 26.0, 600.0, 700.0),
              1e-12);
}

TEST(FirstOrderLag, WithoutALagIsTheTemperatureItself) {
  EXPECT_EQ(LagAfter(18.0, 20.0, 23.0, 300.0, 0.0), 23.0);
  EXPECT_EQ(LagAfter(18.0, 20.0, 23.0, 0.0, 50.0), 18.0);
}

}  // namespace first_order_lag_test
}  // namespace abbe::track
