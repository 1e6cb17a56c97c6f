#include "standards/positioning.h"

#include <gtest/gtest.h>

#include <limits>
#include <tuple>
#include <vector>

#include "failure/failure.h"

namespace abbe::standards {
namespace positioning_test {

// Worked by hand, in whole numbers. Target 0: up 2 +- 1, down -2 +- 2. Target 100: up 5 +- 0, down
// 6 +- 3.
const std::vector<TargetDeviations> kByHand{{0.0, {1, 2, 3}, {0, -2, -4}},
                                            {100.0, {5, 5, 5}, {6, 9, 3}}};

TEST(Positioning, PerTargetByHand) {
  const auto result = EvaluatePositioning(kByHand);
  ASSERT_EQ(result.targets.size(), 2u);
  const auto& [first, second] = std::tie(result.targets[0], result.targets[1]);
  EXPECT_EQ(first.mean_up, 2);
  EXPECT_EQ(first.mean_down, -2);
  EXPECT_EQ(first.mean, 0);
  EXPECT_EQ(first.reversal, 4);
  EXPECT_EQ(first.std_up, 1);
  EXPECT_EQ(first.std_down, 2);
  EXPECT_EQ(first.repeatability_up, 4);
  EXPECT_EQ(first.repeatability_down, 8);
  EXPECT_EQ(first.repeatability, 10);  // 2 + 4 + |4|
  EXPECT_EQ(second.target, 100);
  EXPECT_EQ(second.reversal, -1);
  EXPECT_EQ(second.repeatability, 12);  // R_i down, more than 0 + 6 + |-1|
}

TEST(Positioning, OfTheAxisByHand) {
  const auto result = EvaluatePositioning(kByHand);
  EXPECT_EQ(result.accuracy, 18);  // 6 + 6 down at 100, -2 - 4 down at 0
  EXPECT_EQ(result.accuracy_up, 5);
  EXPECT_EQ(result.accuracy_down, 18);
  EXPECT_EQ(result.repeatability, 12);
  EXPECT_EQ(result.repeatability_up, 4);
  EXPECT_EQ(result.repeatability_down, 12);
  EXPECT_EQ(result.systematic, 8);  // 6 - -2
  EXPECT_EQ(result.systematic_up, 3);
  EXPECT_EQ(result.systematic_down, 8);
  EXPECT_EQ(result.mean_range, 5.5);
  EXPECT_EQ(result.reversal, 4);
  EXPECT_EQ(result.mean_reversal, 1.5);
}

TEST(Positioning, RefusesWhatIsNoTest) {
  EXPECT_THROW(EvaluatePositioning({}), InputError);
  EXPECT_THROW(EvaluatePositioning({{0.0, {1}, {1}}}), InputError);
  EXPECT_THROW(EvaluatePositioning({{0.0, {1, 2}, {1}}}), InputError);
  EXPECT_THROW(EvaluatePositioning({{0.0, {1, 2}, {1, 2}}, {1.0, {1, 2, 3}, {1, 2, 3}}}),
               InputError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(EvaluatePositioning({{0.0, {1, nan}, {1, 2}}}), InputError);
  EXPECT_THROW(EvaluatePositioning({{nan, {1, 2}, {1, 2}}}), InputError);
}

}  // namespace positioning_test
}  // namespace abbe::standards
