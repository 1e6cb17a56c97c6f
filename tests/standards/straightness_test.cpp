#include "standards/straightness.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "failure/failure.h"

namespace abbe::standards {
namespace straightness_test {

using Values = std::vector<double>;
constexpr LineKind kKinds[] = {LineKind::kEndPoints, LineKind::kLeastSquares,
                               LineKind::kMinimumZone};
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();

// Five stations, worked by hand: ends on y = 0, a peak of 4 and a dip of -2.
const Values kX{0, 1, 2, 3, 4}, kY{0, 4, 1, -2, 0};

TEST(Straightness, EndPointsByHand) {
  const auto result = EvaluateStraightness(LineKind::kEndPoints, kX, kY);
  EXPECT_EQ(result.line.slope, 0);
  EXPECT_EQ(result.line.offset, 0);
  EXPECT_EQ(result.deviations, kY);
  EXPECT_EQ(result.error, 6);
}

TEST(Straightness, LeastSquaresByHand) {
  // mean x 2, mean y 0.6; Sxx = 10; Sxy = -1 * 4 + 1 * -2 = -6; slope -0.6, offset 1.8.
  const auto result = EvaluateStraightness(LineKind::kLeastSquares, kX, kY);
  EXPECT_NEAR(result.line.slope, -0.6, kRounding);
  EXPECT_NEAR(result.line.offset, 1.8, kRounding);
  const Values deviations{-1.8, 2.8, 0.4, -2.0, 0.6};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(result.deviations[i], deviations[i], kRounding);
  EXPECT_NEAR(result.error, 4.8, kRounding);
}

TEST(Straightness, MinimumZoneByHand) {
  // The band lies under the peak (1, 4) and on the edge from (0, 0) to (3, -2): slope -2/3, from
  // the offset 0 to 4 + 2/3. The edge from (1, 4) to (4, 0), slope -4/3, gives 16/3 - 0.
  const auto result = EvaluateStraightness(LineKind::kMinimumZone, kX, kY);
  EXPECT_NEAR(result.line.slope, -2.0 / 3, kRounding);
  EXPECT_NEAR(result.line.offset, 7.0 / 3, kRounding);
  EXPECT_NEAR(result.error, 14.0 / 3, kRounding);
}

TEST(Straightness, IsZeroOnALineAndWithTwoPoints) {
  for (const LineKind kind : kKinds) {
    for (const std::size_t n : {2, 3, 7}) {
      Values x, y;
      for (std::size_t i = 0; i < n; ++i) {
        x.push_back(0.25 * static_cast<double>(i * i) - 1);
        y.push_back(3 - 0.5 * x.back());
      }
      const auto result = EvaluateStraightness(kind, x, y);
      EXPECT_NEAR(result.error, 0, kRounding);
      EXPECT_NEAR(result.line.slope, -0.5, kRounding);
      EXPECT_NEAR(result.line.offset, 3, kRounding);
    }
  }
}

// All deviations on one side: nothing is negative, so nothing is added for it.
TEST(Straightness, ABowAboveItsChordCountsOnce) {
  EXPECT_EQ(EvaluateStraightness(LineKind::kEndPoints, Values{0, 1, 2}, Values{5, 7, 5}).error, 2);
}

TEST(Straightness, RefusesWhatMakesNoLine) {
  for (const LineKind kind : kKinds) {
    EXPECT_THROW(EvaluateStraightness(kind, Values{}, Values{}), InputError);
    EXPECT_THROW(EvaluateStraightness(kind, Values{1}, Values{1}), InputError);
    EXPECT_THROW(EvaluateStraightness(kind, Values{1, 2, 3}, Values{1, 2}), InputError);
    EXPECT_THROW(EvaluateStraightness(kind, Values{1, 2, 1}, Values{1, 2, 3}), InputError);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(EvaluateStraightness(kind, Values{1, 2}, Values{1, nan}), InputError);
  }
}

}  // namespace straightness_test
}  // namespace abbe::standards
