#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "standards/positioning.h"
#include "standards/straightness.h"

namespace abbe::standards {
namespace standards_property_test {

// Whole numbers: sums and differences are exact, only slopes round.
std::vector<double> Numbers(std::size_t n, int size) {
  std::vector<double> numbers;
  for (const int i : *rc::gen::container<std::vector<int>>(n, rc::gen::inRange(-size, size + 1))) {
    numbers.push_back(i);
  }
  return numbers;
}

struct Profile {
  std::vector<double> x, y;
};

Profile AnyProfile() {
  auto places = *rc::gen::suchThat(rc::gen::unique<std::vector<int>>(rc::gen::inRange(-50, 51)),
                                   [](const auto& list) { return list.size() >= 2; });
  return {std::vector<double>(places.begin(), places.end()), Numbers(places.size(), 20)};
}

// Slopes up to 40 times places up to 50, some rounding of each.
constexpr double kRounding = 40 * 50 * 16 * std::numeric_limits<double>::epsilon();

// The width of the narrowest band whose border goes through two of the points: O(n^3), no hull.
double NarrowestBand(const Profile& profile) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < profile.x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double slope = (profile.y[i] - profile.y[j]) / (profile.x[i] - profile.x[j]);
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t k = 0; k < profile.x.size(); ++k) {
        low = std::min(low, profile.y[k] - slope * profile.x[k]);
        high = std::max(high, profile.y[k] - slope * profile.x[k]);
      }
      narrowest = std::min(narrowest, high - low);
    }
  }
  return narrowest;
}

RC_GTEST_PROP(StraightnessProperty, MinimumZoneIsTheNarrowestBandOfAll, ()) {
  const Profile profile = AnyProfile();
  const auto result = EvaluateStraightness(LineKind::kMinimumZone, profile.x, profile.y);
  RC_ASSERT(std::abs(result.error - NarrowestBand(profile)) <= kRounding);
  const auto [low, high] = std::minmax_element(result.deviations.begin(), result.deviations.end());
  RC_ASSERT(std::abs(*low + *high) <= kRounding);  // the line runs in the middle
}

RC_GTEST_PROP(StraightnessProperty, MinimumZoneIsAtMostTheOtherTwo, ()) {
  const auto [x, y] = AnyProfile();
  const double minimum = EvaluateStraightness(LineKind::kMinimumZone, x, y).error;
  RC_ASSERT(minimum <= EvaluateStraightness(LineKind::kLeastSquares, x, y).error + kRounding);
  RC_ASSERT(minimum <= EvaluateStraightness(LineKind::kEndPoints, x, y).error + kRounding);
}

RC_GTEST_PROP(StraightnessProperty, ALineAddedChangesTheLineOnly, ()) {
  const Profile profile = AnyProfile();
  const double slope = *rc::gen::inRange(-10, 11), offset = *rc::gen::inRange(-10, 11);
  std::vector<double> tilted = profile.y;
  for (std::size_t i = 0; i < tilted.size(); ++i) tilted[i] += offset + slope * profile.x[i];
  for (const LineKind kind :
       {LineKind::kEndPoints, LineKind::kLeastSquares, LineKind::kMinimumZone}) {
    const auto plain = EvaluateStraightness(kind, profile.x, profile.y);
    const auto result = EvaluateStraightness(kind, profile.x, tilted);
    RC_ASSERT(std::abs(result.error - plain.error) <= kRounding);
  }
}

RC_GTEST_PROP(StraightnessProperty, LeastSquaresDeviationsAreOrthogonalToLines, ()) {
  const auto [x, y] = AnyProfile();
  const auto result = EvaluateStraightness(LineKind::kLeastSquares, x, y);
  double sum = 0, moment = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += result.deviations[i];
    moment += x[i] * result.deviations[i];
  }
  RC_ASSERT(std::abs(sum) <= kRounding * static_cast<double>(x.size()));
  RC_ASSERT(std::abs(moment) <= 50 * kRounding * static_cast<double>(x.size()));
}

std::vector<TargetDeviations> AnyTest() {
  const auto targets = *rc::gen::inRange<std::size_t>(1, 8),
             cycles = *rc::gen::inRange<std::size_t>(2, 7);
  std::vector<TargetDeviations> test;
  for (std::size_t i = 0; i < targets; ++i) {
    test.push_back({static_cast<double>(i), Numbers(cycles, 100), Numbers(cycles, 100)});
  }
  return test;
}

constexpr double kSumRounding =
    1000 * std::numeric_limits<double>::epsilon();  // sums up to some 1000

RC_GTEST_PROP(PositioningProperty, TheFiguresAreOrdered, ()) {
  const auto result = EvaluatePositioning(AnyTest());
  RC_ASSERT(result.accuracy >= result.systematic);
  RC_ASSERT(result.accuracy >= std::max(result.accuracy_up, result.accuracy_down));
  RC_ASSERT(result.systematic >= std::max(result.systematic_up, result.systematic_down));
  RC_ASSERT(result.systematic >= result.mean_range);
  RC_ASSERT(result.systematic >= result.reversal);
  RC_ASSERT(result.repeatability >= std::max(result.repeatability_up, result.repeatability_down));
  RC_ASSERT(result.repeatability >= result.reversal);
  RC_ASSERT(result.reversal >= std::abs(result.mean_reversal) - kSumRounding);
}

RC_GTEST_PROP(PositioningProperty, SwappingTheDirectionsTurnsTheSignOfTheReversalOnly, ()) {
  auto test = AnyTest();
  const auto before = EvaluatePositioning(test);
  for (auto& target : test) std::swap(target.up, target.down);
  const auto after = EvaluatePositioning(test);
  RC_ASSERT(after.mean_reversal == -before.mean_reversal);
  RC_ASSERT(after.accuracy == before.accuracy);
  RC_ASSERT(after.accuracy_up == before.accuracy_down);
  RC_ASSERT(after.repeatability == before.repeatability);
  RC_ASSERT(after.systematic == before.systematic);
  RC_ASSERT(after.mean_range == before.mean_range);
}

}  // namespace standards_property_test
}  // namespace abbe::standards
