#include "history/trend.h"

#include <cmath>

#include "made_campaign.h"
#include "random/counter_random.h"
#include "standards/student_coverage.h"

namespace abbe::history {
namespace trend_test {

constexpr double kDay = 86400.0, kStart = 1.7e9;

// Points a day apart with values and uncertainties.
std::vector<Point> Points(const std::vector<double>& values, std::optional<double> u,
                          const Shares& shares = {}, const std::string& quantity = "range_um") {
  std::vector<Point> points;
  for (std::size_t i = 0; i < values.size(); ++i) {
    points.push_back({static_cast<long long>(i + 1),
                      kStart + kDay * static_cast<double>(i),
                      0.0,
                      {"EXX", quantity, "", values[i], u, 2.0, shares}});
  }
  return points;
}

TEST(FollowFigure, ALineIsFoundWithItsUncertainty) {
  const auto trend = FollowFigure(Points({1, 3, 5, 7}, 0.4), {}, {.now = kStart + 9 * kDay});
  ASSERT_TRUE(trend.fit);
  EXPECT_NEAR(kDay * trend.fit->rate, 2.0, 1e-9);
  EXPECT_NEAR(trend.fit->value, 4.0, 1e-9);
  EXPECT_EQ(trend.fit->excess, 0.0);
  // sum (t - t_0)^2 = 5 days^2.
  EXPECT_NEAR(kDay * trend.fit->u_rate, 0.4 / std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(trend.fit->u_value, 0.2, 1e-9);
  EXPECT_NEAR(trend.fit->coverage, 4.302652729911275, 1e-9);  // scipy.stats.t.ppf(0.975, 2)
}

// Residuals d (1, -1, -1, 1) lie across every line: s^2 = 4 d^2 / 2 - u^2.
TEST(FollowFigure, ExcessScatterIsWhatUDoesNotExplain) {
  const double d = 0.5, u = 0.3;
  const auto trend =
      FollowFigure(Points({1 + d, 2 - d, 3 - d, 4 + d}, u), {}, {.now = kStart + 9 * kDay});
  EXPECT_NEAR(trend.fit->excess, std::sqrt(2.0 * d * d - u * u), 1e-9);
  EXPECT_NEAR(kDay * trend.fit->rate, 1.0, 1e-9);
  EXPECT_NEAR(kDay * trend.fit->u_rate, std::sqrt(2.0) * d / std::sqrt(5.0), 1e-9);
}

TEST(FollowFigure, WithoutUncertaintyItIsOrdinaryLeastSquares) {
  const double d = 0.5;
  const auto trend =
      FollowFigure(Points({1 + d, 2 - d, 3 - d, 4 + d}, {}), {}, {.now = kStart + 9 * kDay});
  EXPECT_NEAR(trend.fit->excess, std::sqrt(2.0) * d, 1e-9);
  EXPECT_NEAR(kDay * trend.fit->u_rate, std::sqrt(2.0 / 5.0) * d, 1e-9);
  EXPECT_EQ(FollowFigure(Points({1, 2, 3}, {}), {}, {.now = kStart + 9 * kDay}).fit->U95_rate, 0.0);
}

TEST(FollowFigure, AnInstrumentThatAllShareShiftsNoRate) {
  const std::map<std::string, std::string> same{{"head", "P-12"}, {"mounting", "A"}};
  const auto points = Points({1, 3, 5, 7}, 0.4, {{"head", 0.75}});
  const auto u_rate = [&](const std::map<std::string, std::string>& of_last) {
    return *FollowFigure(points, {{1, same}, {2, same}, {3, same}, {4, of_last}},
                         {.now = kStart + 9 * kDay})
                .fit;
  };
  EXPECT_NEAR(kDay * u_rate(same).u_rate, 0.2 / std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(u_rate(same).u_common, 0.4 * std::sqrt(0.75), 1e-9);
  EXPECT_NEAR(u_rate(same).U95_value, u_rate(same).coverage * std::sqrt(0.01 + 0.16 * 0.75), 1e-9);
  EXPECT_NEAR(kDay * u_rate({{"head", "P-13"}, {"mounting", "A"}}).u_rate, 0.4 / std::sqrt(5.0),
              1e-9);
}

TEST(FollowFigure, TheLimitIsReachedWhereTheLineMeetsIt) {
  // Level 4 at day 1.5, 2 a day: 10 on day 4.5.
  const double now = kStart + 3 * kDay;
  const auto trend = FollowFigure(Points({1, 3, 5, 7}, 0.05), {}, {.limit = 10.0, .now = now});
  ASSERT_TRUE(trend.reached);
  EXPECT_NEAR(*trend.reached->expected, kStart + 4.5 * kDay, 1.0);
  EXPECT_FALSE(trend.reached->already);
  // Fieller: at both ends the distance to the limit is the expanded uncertainty there.
  for (const double end : {*trend.reached->earliest, *trend.reached->latest}) {
    EXPECT_NEAR(std::abs(trend.fit->At(end) - 10.0), trend.fit->U95At(end), 1e-6);
  }
  EXPECT_LT(*trend.reached->earliest, *trend.reached->expected);
  EXPECT_GT(*trend.reached->latest, *trend.reached->expected);
}

TEST(FollowFigure, WithoutADriftOnlyTheEarliestInstantIsKnown) {
  const double now = kStart + 3 * kDay;
  const auto trend =
      FollowFigure(Points({1.0, 1.2, 0.9, 1.1}, 0.1), {}, {.limit = 3.0, .now = now});
  EXPECT_FALSE(trend.fit->drifts);
  ASSERT_TRUE(trend.reached);
  EXPECT_FALSE(trend.reached->expected);
  ASSERT_TRUE(trend.reached->earliest);
  EXPECT_GT(*trend.reached->earliest, now);
  EXPECT_NEAR(trend.fit->At(*trend.reached->earliest) + trend.fit->U95At(*trend.reached->earliest),
              3.0, 1e-6);
}

TEST(FollowFigure, ASignedFigureHasALimitOnBothSides) {
  const auto points = Points({-1, -3, -5, -7}, 0.05, {}, "urad");
  const auto trend = FollowFigure(points, {}, {.limit = 10.0, .now = kStart + 3 * kDay});
  EXPECT_NEAR(*trend.reached->expected, kStart + 4.5 * kDay, 1.0);
  // A range that falls never meets its limit.
  const auto falling =
      FollowFigure(Points({7, 5, 3, 1}, 0.05), {}, {.limit = 10.0, .now = kStart + 3 * kDay});
  EXPECT_FALSE(falling.reached);
  const auto beyond =
      FollowFigure(Points({7, 5, 3, 1}, 0.05), {}, {.limit = 0.5, .now = kStart + 3 * kDay});
  EXPECT_TRUE(beyond.reached->already);
}

TEST(FollowFigure, ClocksThatJumpAreSaid) {
  auto points = Points({1, 3, 5, 7}, 0.1);
  points.push_back(points.back());
  points.back().measured = kStart + 4000 * kDay;
  points.back().campaign = 5;
  points.back().figure.value = 1000.0;
  const auto trend = FollowFigure(points, {}, {.now = kStart + 9 * kDay});
  EXPECT_NEAR(kDay * trend.fit->rate, 2.0, 1e-9);
  EXPECT_FALSE(trend.points.back().used);
  ASSERT_EQ(trend.notes.size(), 1U);
  ExpectHas(trend.notes.front(), "1 of its campaigns is dated in the future (campaign 5");
  std::vector<CampaignHead> campaigns(3);
  for (long long i = 0; i < 3; ++i) campaigns[static_cast<std::size_t>(i)].id = i + 1;
  campaigns[0].measured = kStart;
  campaigns[1].measured = kStart + 2 * kDay;
  campaigns[2].measured = kStart + 1 * kDay;
  const auto notes = OutOfOrder(campaigns);
  ASSERT_EQ(notes.size(), 1U);
  ExpectHas(notes.front(), "campaign 3 was added after campaign 2 but is dated before it");
  campaigns[2].measured = kStart + 3 * kDay;
  EXPECT_TRUE(OutOfOrder(campaigns).empty());
}

TEST(FollowFigure, TwoInstantsGiveNoRate) {
  const auto trend = FollowFigure(Points({1, 3}, 0.1), {}, {.now = kStart + 9 * kDay});
  EXPECT_FALSE(trend.fit);
  ExpectHas(trend.notes.front(), "2 instants: a rate takes at least 3");
}

// The share of 3000 draws in which U95 of the rate covers it: 12 points of which u = 0.3 is stated,
// with an excess of this size and correlation from one to the next.
double CoveredRates(double excess, double memory) {
  constexpr int kTimes = 3000, kPoints = 12;
  const random::CounterRandom draw(11, 2);
  std::uint64_t index = 0;
  int covered = 0;
  for (int time = 0; time < kTimes; ++time) {
    std::vector<double> values;
    double room = draw.Normal(index++);
    for (int i = 0; i < kPoints; ++i) {
      values.push_back(0.1 * i + 0.3 * draw.Normal(index++) + excess * room);
      room = memory * room + std::sqrt(1.0 - memory * memory) * draw.Normal(index++);
    }
    const auto trend = FollowFigure(Points(values, 0.3), {}, {.now = kStart + 99 * kDay});
    covered += std::abs(kDay * trend.fit->rate - 0.1) <= kDay * trend.fit->U95_rate ? 1 : 0;
  }
  return covered / static_cast<double>(kTimes);
}

// Within three standard deviations of the count and the 1 % by which Student's t with n - 2 degrees
// of freedom is known to be off for an estimated excess. Where there is a scatter, that it may
// have a memory is reckoned with: at most half of what was left uncovered.
TEST(FollowFigure, TheRateIsCovered) {
  const double tolerance = 3.0 * std::sqrt(0.95 * 0.05 / 3000) + 0.01;
  for (const double excess : {0.0, 0.5}) {
    EXPECT_GT(CoveredRates(excess, 0.0), 0.95 - tolerance) << excess;
    EXPECT_LT(CoveredRates(excess, 0.0), 0.975 + tolerance) << excess;
  }
}

// The season goes on from one campaign to the next: as if each scattered for itself, U95 would
// cover about 60 % (0.8) and 80 % (0.5).
TEST(FollowFigure, TheRateIsCoveredBesideAScatterThatGoesOn) {
  EXPECT_GT(CoveredRates(3.0, 0.8), 0.82);
  EXPECT_GT(CoveredRates(3.0, 0.5), 0.90);
}

}  // namespace trend_test
}  // namespace abbe::history
