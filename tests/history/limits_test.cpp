#include "history/limits.h"

#include "history/conformity.h"
#include "made_campaign.h"

namespace abbe::history {
namespace limits_test {

Limits LimitsOf(const std::string& text) {
  const auto document = settings::Document::Parse(text, "mill.toml");
  return ReadLimits(document.Root());
}

TEST(Limits, AreThoseOfTheFile) {
  const Limits limits = LimitsOf(R"([limits]
circularity_um = 5
EYX = { straightness_um = 3.0 }
C0Y = { urad = 30 }
X = { positioning_A_um = 6, positioning_A_u95_um = 0.8 }
XY = { circularity_um = 4 }
)");
  ASSERT_EQ(limits.size(), 5U);
  EXPECT_EQ(LimitOf("EYX", "straightness_um", limits)->size, 3.0);
  EXPECT_EQ(LimitOf("X", "positioning_A_um", limits)->stated_u95, 0.8);
  EXPECT_EQ(LimitOf("XY", "circularity_um", limits)->size, 4.0);
  EXPECT_EQ(LimitOf("YZ", "circularity_um", limits)->size, 5.0);
  EXPECT_EQ(LimitOf("EZX", "straightness_um", limits), nullptr);
}

TEST(Limits, OfWhatDoesNotExistAreRefusedWithTheNearestName) {
  const auto refusal = [](const std::string& text) {
    return MessageOf<InputError>([&] { LimitsOf("[limits]\n" + text); });
  };
  EXPECT_EQ(refusal("EYQ = { straightness_um = 3 }"),
            "mill.toml:2: limits.EYQ: there is no such error, axis or plane; did you mean "
            "\"EYX\"?");
  EXPECT_EQ(refusal("EYX = { straightnes_um = 3 }"),
            "mill.toml:2: limits.EYX.straightnes_um: is not a known key; did you mean "
            "\"straightness_um\"?");
  EXPECT_EQ(refusal("circularty_um = 3"),
            "mill.toml:2: limits.circularty_um: is not a known key; did you mean "
            "\"circularity_um\"?");
  ExpectHas(refusal("EXX = { straightness_um = 3 }"), "is not a known key");
  ExpectHas(refusal("EYX = { straightness_um = -1 }"), "must be at least 0");
  ExpectHas(refusal("X = { positioning_A_u95_um = 1 }"), "needs the limit positioning_A_um");
  ExpectHas(MessageOf<InputError>([] {
              LimitsOf("axis.X.travel_mm = [0, 1]\n[limits]\nEXZ = { straightness_um = 3 }");
            }),
            "this machine has no axis Z");
}

// The rule at its borders: 2.5 + 0.5 = 3 passes, 3.5 - 0.5 = 3 is not beyond 3.
TEST(Judge, FollowsIso14253) {
  const Limits limits = LimitsOf("[limits]\nEYX = { straightness_um = 3.0 }\n");
  const auto verdict = [&](double value, std::optional<double> u) {
    return Judge({{"EYX", "straightness_um", "", value, u}}, limits).front().verdict;
  };
  EXPECT_EQ(verdict(2.5, 0.25), Verdict::kPass);
  EXPECT_EQ(verdict(2.6, 0.25), Verdict::kUndecided);
  EXPECT_EQ(verdict(3.5, 0.25), Verdict::kUndecided);
  EXPECT_EQ(verdict(3.6, 0.25), Verdict::kFail);
  EXPECT_EQ(verdict(0.1, std::nullopt), Verdict::kUndecided);
  EXPECT_EQ(verdict(9.0, std::nullopt), Verdict::kUndecided);
}

TEST(Judge, PassesNothingThatLeavesStationsOut) {
  const Limits limits = LimitsOf("[limits]\nEYX = { straightness_um = 3.0 }\n");
  const auto judged = [&](double value, const Stations& stations, const Travels& travels) {
    Figure figure{"EYX", "straightness_um", "", value, 0.1};
    figure.stations = stations;
    return Judge({figure}, limits, travels).front();
  };
  const Travels travels{{'X', {0.0, 100.0}}};
  EXPECT_EQ(judged(1.0, {'X', 0.0, 100.0, 11, 0}, travels).verdict, Verdict::kPass);
  EXPECT_EQ(judged(1.0, {'X', 5.0, 95.0, 0, 0}, travels).verdict, Verdict::kPass);
  EXPECT_EQ(judged(1.0, {'X', 0.0, 89.0, 9, 0}, travels).verdict, Verdict::kUndecided);
  EXPECT_EQ(judged(1.0, {'X', 0.0, 100.0, 11, 1}, travels).reason,
            "1 of 11 planned stations are missing");
  EXPECT_EQ(judged(4.0, {'X', 0.0, 50.0, 11, 5}, travels).verdict, Verdict::kFail);
  EXPECT_EQ(ReadTravels(settings::Document::Parse("axis.X.travel_mm = [-5, 100]", "m").Root())
                .at('X')
                .first_mm,
            -5.0);
}

TEST(Judge, TakesTheAmountOfASignedFigureAndTheStatedUncertainty) {
  const Limits limits = LimitsOf(R"([limits]
C0Y = { urad = 30 }
positioning_A_um = 8
positioning_A_u95_um = 1
)");
  const auto judged = Judge(
      {{"C0Y", "urad", "", -40.0, 2.0}, {"X", "positioning_A_um", "", 6.5, std::nullopt}}, limits);
  ASSERT_EQ(judged.size(), 2U);
  EXPECT_EQ(judged[0].verdict, Verdict::kFail);
  EXPECT_EQ(judged[1].verdict, Verdict::kPass);
  EXPECT_TRUE(judged[1].u_from_limit);
}

TEST(Judge, NamesALimitWithoutAFigure) {
  const auto judged = Judge({}, LimitsOf("[limits]\nvolumetric_um = 20\n"));
  ASSERT_EQ(judged.size(), 1U);
  EXPECT_EQ(judged[0].verdict, Verdict::kNotMeasured);
}

}  // namespace limits_test
}  // namespace abbe::history
