// The grammar of learned terms: text and back, closed forms, what is refused.
#include "simulation/learned/expression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "failure/failure.h"
#include "simulation/learned/learned_term.h"

namespace abbe::simulation {
namespace expression_test {

using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr Index kRows = 201;

// X from 0 to 100 mm and back within 1000 s, Y at half of it.
Trace ThereAndBack() {
  Trace trace;
  trace.time = trace.clock = VectorXd::LinSpaced(kRows, 0.0, 1000.0);
  trace.clock.array() += 50.0;
  trace.axes = trace.velocity = trace.acceleration = trace.heading =
      Eigen::Matrix3Xd::Zero(3, kRows);
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, kRows, kLongAgo);
  for (Index row = 0; row < kRows; ++row) {
    trace.axes(0, row) = 0.1 - std::abs(0.1 - 0.2 * static_cast<double>(row) / (kRows - 1));
    trace.axes(1, row) = 0.5 * trace.axes(0, row);
    trace.heading(0, row) = row <= (kRows - 1) / 2 ? 1.0 : -1.0;
    trace.velocity(0, row) = 0.2e-3 * trace.heading(0, row);
  }
  trace.sensors = {"temp_table_c"};
  trace.temperature = Eigen::MatrixXd::Constant(1, kRows, 21.0);
  trace.warming = Eigen::MatrixXd::Constant(1, kRows, 1.0);
  trace.warming(0, 0) = 0.0;
  trace.others = {"load_n"};
  trace.other = RowVectorXd::LinSpaced(kRows, 0.0, 400.0);
  return trace;
}

class TextAndBack : public testing::TestWithParam<const char*> {};

TEST_P(TextAndBack, IsTheSame) {
  const Expression expression = ParseExpression(GetParam());
  EXPECT_EQ(expression.Text(), GetParam());
  EXPECT_EQ(ParseExpression(expression.Text()).terms, expression.terms);
}

INSTANTIATE_TEST_SUITE_P(
    OfTheGrammar, TextAndBack,
    testing::Values("x", "x^2", "abs(speed of x)", "sin(2 pi x+y / 12.5)",
                    "sin(2 pi x / 5) + cos(2 pi x / 5)", "step(x - 31.4)", "step(y + 2)",
                    "max(0, feed - 1200)", "exp(-time of run / 300)",
                    "lag(warming of temp_table_c, 600)", "play(pivot_1, 0.01)", "sign(z)",
                    "bspline(x, -10, 110, 12)", "x * y", "sign(x) * step(y - 3)",
                    "x * y + step(z - 1e-05) + column load_n", "rate of temp_table_c",
                    "gap of probe_a^2", "way of x * x-z"));

struct Refused {
  const char* text;
  const char* why;
};
class Nonsense : public testing::TestWithParam<Refused> {};

TEST_P(Nonsense, IsRefusedWithItsReason) {
  try {
    (void)ParseExpression(GetParam().text);
    FAIL() << GetParam().text;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(GetParam().why)) << GetParam().text;
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheGrammar, Nonsense,
                         testing::Values(Refused{"", "which is no variable"},
                                         Refused{"w", "which is no variable"},
                                         Refused{"step(x - y)", "where a number belongs"},
                                         Refused{"exp(-x / -3)", "above zero"},
                                         Refused{"lag(x)", "lacks its number"},
                                         Refused{"x * y * z", "product of more than two"},
                                         Refused{"x + y + z + x", "more than three terms"},
                                         Refused{"sign(feed)", "of no axis and no pivot"},
                                         Refused{"bspline(x, 3, 3, 4)", "empty range"},
                                         Refused{"bspline(x, 0, 3, 2.5)", "whole number of parts"},
                                         Refused{"x * bspline(x, 0, 3, 2)", "stands alone"},
                                         Refused{"exp(-x / nan)", "where a number belongs"}));

TEST(Expression, HasItsClosedForm) {
  const Trace trace = ThereAndBack();
  const Eigen::ArrayXd x = 1e3 * trace.axes.row(0).transpose().array(),
                       y = 1e3 * trace.axes.row(1).transpose().array();
  const auto of = [&](const char* text) -> Eigen::ArrayXd {
    return ParseExpression(text).Of(trace).row(0).transpose().array();
  };
  constexpr double kRounding = 1e-12;
  EXPECT_LT((of("x * y") - x * y).abs().maxCoeff(), kRounding * 1e4);
  EXPECT_LT((of("max(0, x - 31.4)") - (x - 31.4).max(0.0)).abs().maxCoeff(), kRounding * 100);
  EXPECT_LT((of("sin(2 pi x / 5)") - (2.0 * M_PI * x / 5.0).sin()).abs().maxCoeff(), 1e-11);
  EXPECT_TRUE((of("step(x - 31.4)") == (x >= 31.4).cast<double>()).all());
  EXPECT_LT((of("exp(-time of run / 300)") - (-trace.time.array() / 300.0).exp()).abs().maxCoeff(),
            kRounding);
  EXPECT_LT((of("time") - trace.clock.array()).abs().maxCoeff(), kRounding);
  EXPECT_LT((of("sign(x) * x") - trace.heading.row(0).transpose().array() * x).abs().maxCoeff(),
            kRounding * 100);
  EXPECT_LT((of("speed of x") - 12.0 * trace.heading.row(0).transpose().array()).abs().maxCoeff(),
            1e-9);  // 0.2 mm/s
  EXPECT_LT((of("column load_n") - trace.other.row(0).transpose().array()).abs().maxCoeff(),
            kRounding);
  EXPECT_EQ(ParseExpression("pivot_1").Of(trace).size(), 0);
}

// After a step of 1 K a lag of 600 s has 1 - exp(-t / 600).
TEST(Expression, LagsExponentially) {
  const Trace trace = ThereAndBack();
  const RowVectorXd lagged = ParseExpression("lag(warming of temp_table_c, 600)").Of(trace).row(0);
  for (Index row = 1; row < kRows; ++row) {
    EXPECT_NEAR(lagged[row], 1.0 - std::exp(-trace.time[row] / 600.0), 1e-12);
  }
}

// A play follows by half of its width behind; after a reversal it stands for the whole width.
TEST(Expression, HasPlay) {
  const Trace trace = ThereAndBack();
  const RowVectorXd play = ParseExpression("play(x, 10)").Of(trace).row(0);
  const Index middle = (kRows - 1) / 2;
  EXPECT_DOUBLE_EQ(play[0], 0.0);
  EXPECT_DOUBLE_EQ(play[middle], -0.5);
  EXPECT_NEAR(play[middle + 5], 0.0, 1e-12);  // 5 mm back
  EXPECT_NEAR(play[middle + 20], 0.5, 1e-12);
}

TEST(Expression, SplinesAreAPartitionOfOne) {
  const Trace trace = ThereAndBack();
  const Expression spline = ParseExpression("bspline(x, 0, 100, 8)");
  EXPECT_EQ(spline.columns(), 11);
  const Eigen::MatrixXd functions = spline.Of(trace);
  EXPECT_LT((functions.colwise().sum().array() - 1.0).abs().maxCoeff(), 1e-12);
}

LearnedTerm StepOfY() {
  LearnedTerm term{.object = "EYX",
                   .expression = ParseExpression("step(x - 31.4)"),
                   .coefficients = VectorXd::Constant(1, 1.21e-6),
                   .covariance = Eigen::MatrixXd::Constant(1, 1, 4e-16),
                   .u95_of_numbers = {0.1},
                   .covered = {{"x", 0.0, 60.0}}};
  term.certificate = {1e-7, 1.4, 1.01, kHolds, 0.31, "backlash:Y", 0.12};
  return term;
}

TEST(LearnedTermFile, ReadsWhatItWrote) {
  const LearnedTerm term = StepOfY();
  const auto document = settings::Document::Parse(LearnedTermText(term), "learned.toml");
  const auto tables = document.Root().Children("learned");
  ASSERT_EQ(tables.size(), 1U);
  const LearnedTerm read = ReadLearnedTerm(tables.front());
  EXPECT_EQ(LearnedTermText(read), LearnedTermText(term));
  EXPECT_DOUBLE_EQ(read.coefficients[0], 1.21e-6);
  EXPECT_EQ(read.certificate.regime, kHolds);
}

TEST(LearnedCause, ActsAtItsStageWithinWhatWasCovered) {
  const Trace trace = ThereAndBack();
  LearnedTerm term = StepOfY();
  term.expression = ParseExpression("x");
  const auto learned = LearnedCause::Of(term);
  const auto columns = learned->cause().columns(trace, learned->object(), {});
  ASSERT_EQ(columns.size(), 1U);
  ASSERT_EQ(columns[0].stages().size(), 1U);
  EXPECT_EQ(columns[0].stages().begin()->first, MotionStage(0, 1));
  const RowVectorXd values = columns[0].stages().begin()->second;
  EXPECT_NEAR(values[50], 50.0, 1e-9);
  EXPECT_NEAR(values[100], 60.0, 1e-9);  // at 100 mm as at the border
}

// A function of the own position is in the map; what follows speed is not, and what a probe does is
// the instrument's.
TEST(LearnedCause, SitsWhereItIsDealtWith) {
  LearnedTerm term = StepOfY();
  const auto seat = [&](const char* object, const char* text) {
    term.object = object;
    term.expression = ParseExpression(text);
    term.coefficients = VectorXd::Constant(term.expression.columns(), 1e-6);
    const auto learned = LearnedCause::Of(term);
    return learned->cause().CorrectedAt(learned->object());
  };
  EXPECT_EQ(seat("EYX", "step(x - 31.4)"), CorrectedBy::kMap);
  EXPECT_EQ(seat("EYX", "x * y"), CorrectedBy::kMotion);
  EXPECT_EQ(seat("X", "feed^2"), CorrectedBy::kMotion);
  EXPECT_EQ(seat("probe_b", "time"), CorrectedBy::kInstrument);
  EXPECT_EQ(seat("pivot_1", "pivot_1^2"), CorrectedBy::kInstrument);
}

}  // namespace expression_test
}  // namespace abbe::simulation
