#include "history/comparison.h"

#include <algorithm>
#include <cmath>

#include "made_campaign.h"
#include "random/counter_random.h"

namespace abbe::history {
namespace comparison_test {

constexpr double kRounding = 1e-12;

StoredCampaign Made(std::vector<Figure> figures,
                    std::map<std::string, std::string> instruments = {},
                    std::vector<Curve> curves = {}) {
  StoredCampaign campaign;
  campaign.head.machine = "mill";
  campaign.instruments = std::move(instruments);
  campaign.results.push_back(MadeResult(std::move(figures), 0.0, "made"));
  campaign.results.back().extract.curves = std::move(curves);
  return campaign;
}

Figure Straightness(double value, double u, double coverage = 2.0) {
  return {"EYX", "straightness_um", "", value, u, coverage, {{"head", 0.64}}};
}

TEST(Compare, TheSameHeadInTheSameMountingCancels) {
  const std::map<std::string, std::string> same{{"head", "P-12"}, {"mounting", "A"}};
  const auto U95 = [&](const std::map<std::string, std::string>& before) {
    return *Compare(Made({Straightness(2.0, 1.0)}, before), Made({Straightness(3.0, 1.0)}, same))
                .differences.front()
                .U95;
  };
  // A part of 0.36 of each variance of 1 is its own; otherwise all of 2 counts.
  EXPECT_NEAR(U95(same), 2.0 * std::sqrt(0.72), kRounding);
  EXPECT_NEAR(U95({{"head", "P-13"}, {"mounting", "A"}}), 2.0 * std::sqrt(2.0), kRounding);
  EXPECT_NEAR(U95({{"head", "P-12"}, {"mounting", "B"}}), 2.0 * std::sqrt(2.0), kRounding);
  EXPECT_NEAR(U95({{"head", "P-12"}}), 2.0 * std::sqrt(2.0), kRounding);
  EXPECT_NEAR(U95({}), 2.0 * std::sqrt(2.0), kRounding);
}

// Parts of 0.8 and 0.4 of one instrument leave 0.4, own parts of 0.6 and 0.3.
TEST(Compare, SharedPartsOfDifferentSizeLeaveTheirDifference) {
  const std::map<std::string, std::string> same{{"head", "P-12"}, {"mounting", "A"}};
  const auto comparison =
      Compare(Made({Straightness(2.0, 1.0)}, same), Made({Straightness(3.0, 0.5)}, same));
  EXPECT_NEAR(*comparison.differences.front().U95, 2.0 * std::sqrt(0.36 + 0.09 + 0.16), kRounding);
  EXPECT_EQ(comparison.differences.front().shared, std::vector<std::string>{"head"});
}

// Changes of 2.5 and 2.1 standard deviations have p of 0.0124 and 0.0357. Holm's bounds of two are
// 0.025 and 0.05, of three 0.0167 and 0.025.
TEST(Compare, SignificanceIsThatOfTheFamily) {
  const auto figure = [](const char* object, double value) {
    return Figure{object, "range_urad", "", value, std::sqrt(0.5)};
  };
  const auto significant = [](const Comparison& comparison) {
    return std::ranges::count(comparison.differences, true, &Difference::significant);
  };
  EXPECT_EQ(significant(Compare(Made({figure("EAX", 0), figure("EBX", 0)}),
                                Made({figure("EAX", 2.5), figure("EBX", 2.1)}))),
            2);
  EXPECT_EQ(
      significant(Compare(Made({figure("EAX", 0), figure("EBX", 0), figure("ECX", 0)}),
                          Made({figure("EAX", 2.5), figure("EBX", 2.1), figure("ECX", 0.1)}))),
      1);
}

// Two coverage factors of 3 degrees of freedom: Welch and Satterthwaite give 6.
TEST(Compare, FewDegreesOfFreedomWiden) {
  const double k3 = 3.182446305284263, k6 = 2.446911848791681;  // scipy.stats.t.ppf(0.975, ...)
  const auto comparison =
      Compare(Made({Straightness(2.0, 1.0, k3)}), Made({Straightness(3.0, 1.0, k3)}));
  EXPECT_NEAR(*comparison.differences.front().U95, k6 * std::sqrt(2.0), 1e-6);
}

TEST(Compare, CurvesWhereTheyDiffer) {
  const Curve before{"EYX", "um", "sweep", {0, 10, 20}, {0, 0, 0}, {0.1, 0.1, 0.1}, 2.0, {}};
  Curve after{"EYX", "um", "sweep", {5, 15, 25}, {0.0, 1.0, 9.0}, {0.1, 0.1, 0.1}, 2.0, {}};
  const auto comparison = Compare(Made({}, {}, {before}), Made({}, {}, {after}));
  const Difference& curve = comparison.differences.front();
  // 25 mm lies beyond the earlier curve; 1.0 is 7 standard deviations.
  EXPECT_EQ(curve.positions_mm, (std::vector<double>{5, 15}));
  EXPECT_EQ(curve.at_mm, 15.0);
  EXPECT_NEAR(curve.change, 1.0, kRounding);
  EXPECT_NEAR(*curve.U95, 2.0 * std::sqrt(0.02), kRounding);
  EXPECT_TRUE(curve.significant);
  // Bonferroni: twice the smaller of two.
  EXPECT_NEAR(*curve.p, 2.0 * std::erfc(1.0 / std::sqrt(0.02) / std::sqrt(2.0)), 1e-15);
}

TEST(Compare, WithoutUncertaintyNothingIsSignificant) {
  const Figure none{"X", "positioning_A_um", "", 5.0, std::nullopt};
  Figure later = none;
  later.value = 50.0;
  const auto comparison = Compare(Made({none}), Made({later}));
  EXPECT_FALSE(comparison.differences.front().p);
  EXPECT_FALSE(comparison.differences.front().significant);
  EXPECT_EQ(comparison.differences.front().change, 45.0);
}

TEST(Compare, OnlyTheSameConditionsAndMachines) {
  const Figure slow{"XY", "circularity_um", "F 300", 4.0, 0.1};
  Figure fast = slow;
  fast.conditions = "F 2000";
  ExpectHas(MessageOf<InputError>([&] { Compare(Made({slow}), Made({fast})); }),
            "no figure in common");
  auto other = Made({slow});
  other.head.machine = "lathe";
  ExpectHas(MessageOf<InputError>([&] { Compare(Made({slow}), other); }), "of one machine");
  const auto comparison = Compare(Made({slow}), Made({slow, fast}));
  EXPECT_EQ(comparison.only_after, std::vector<std::string>{"XY.circularity_um (F 2000)"});
}

TEST(Compare, FindingsComeAndGo) {
  auto before = Made({Straightness(2.0, 1.0)}), after = before;
  before.results.front().extract.findings = {{"backlash", "X", 0.99}, {"backlash", "Y", 0.99}};
  after.results.front().extract.findings = {{"backlash", "Y", 0.99}, {"servo-lag", "X", 0.9}};
  const auto comparison = Compare(before, after);
  ASSERT_EQ(comparison.new_findings.size(), 1U);
  EXPECT_EQ(comparison.new_findings.front().cause, "servo-lag");
  ASSERT_EQ(comparison.gone_findings.size(), 1U);
  EXPECT_EQ(comparison.gone_findings.front().object, "X");
}

// 20 figures of an unchanged machine, half of them correlated: any false alarm in at most 5 % of
// 4000 comparisons, and not in far fewer. Three standard deviations of the count.
TEST(Compare, FalseAlarmsAreThoseOfTheLevel) {
  constexpr int kTimes = 4000, kFigures = 20;
  const random::CounterRandom draw(5, 1);
  std::uint64_t index = 0;
  int alarms = 0;
  for (int time = 0; time < kTimes; ++time) {
    std::vector<Figure> before, after;
    const double common = draw.Normal(index++);
    for (int i = 0; i < kFigures; ++i) {
      const std::string object = std::string("E").append(std::to_string(i));
      const double own = draw.Normal(index++);
      const double error = i % 2 == 0 ? own : std::sqrt(0.5) * (common + own);
      before.push_back({object, "range_um", "", 0.0, 0.0});
      after.push_back({object, "range_um", "", error, 1.0});
    }
    const auto comparison = Compare(Made(std::move(before)), Made(std::move(after)));
    alarms += comparison.differences.front().significant ? 1 : 0;
  }
  const double expected = 0.05 * kTimes, spread = std::sqrt(0.05 * 0.95 * kTimes);
  EXPECT_LT(alarms, expected + 3.0 * spread);
  EXPECT_GT(alarms, 0.75 * expected - 3.0 * spread);
}

}  // namespace comparison_test
}  // namespace abbe::history
