// What each cause does, against its definition by hand on a short path.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "failure/failure.h"
#include "simulation/causes/registry.h"

namespace abbe::simulation {
namespace causes_test {

using Eigen::RowVectorXd;
using Eigen::VectorXd;

// X goes to and fro by 1 mm a row, a second each; one pivot turns with it.
Trace ToAndFro() {
  Trace trace;
  constexpr Eigen::Index kRows = 8;
  trace.time = trace.clock = VectorXd::LinSpaced(kRows, 0.0, kRows - 1.0);
  trace.axes = Eigen::Matrix3Xd::Zero(3, kRows);
  trace.axes.row(0) << 0.0, 1e-3, 2e-3, 3e-3, 4e-3, 3e-3, 2e-3, 1e-3;
  trace.axes.row(1).setConstant(5e-3);
  trace.heading = trace.velocity = Eigen::Matrix3Xd::Zero(3, kRows);
  trace.heading.row(0) = HeadingOf(trace.axes.row(0), 1e-6);
  trace.velocity.row(0) = 1e-3 * trace.heading.row(0);
  trace.ball_way = -trace.heading;  // a table
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, kRows, kLongAgo);
  trace.since_reversal.row(0).tail(3) << 1e-3, 2e-3, 3e-3;
  trace.angles = trace.axes.topRows(1) * 100.0;
  trace.turning = trace.heading.topRows(1);
  trace.link = Eigen::MatrixXd::Zero(3, kRows);
  trace.link.row(2).setOnes();
  trace.sensors = {"temp_table_c"};
  trace.warming = RowVectorXd::LinSpaced(kRows, 0.0, 0.7);
  return trace;
}

// What a disturbance does at a stage; it may not act at another one.
RowVectorXd At(const Disturbance& disturbance, Eigen::Index stage, const std::string& id) {
  for (const auto& [other, values] : disturbance.stages()) {
    if (other == stage) continue;
    EXPECT_TRUE(values.isZero(0.0)) << id << " acts at another stage too";
  }
  return disturbance.stages().at(stage);
}

RowVectorXd Only(const Cause& cause, const std::string& object, Eigen::Index stage,
                 const VectorXd& shape = {}) {
  const auto columns = cause.columns(ToAndFro(), object, shape);
  EXPECT_EQ(columns.size(), static_cast<std::size_t>(cause.coefficients()));
  return At(columns.front(), stage, cause.id);
}

TEST(Causes, BacklashLagsByHalfInEachDirection) {
  const RowVectorXd x = Only(Backlash(), "X", Positioning(0));
  EXPECT_EQ(x, RowVectorXd((RowVectorXd(8) << -.5, -.5, -.5, -.5, -.5, .5, .5, .5).finished()));
}

TEST(Causes, CyclicErrorHasItsPitchAmplitudeAndPhase) {
  const Cause cause = LeadscrewCyclic();
  const VectorXd pitch = VectorXd::Constant(1, 4e-3);
  const auto columns = cause.columns(ToAndFro(), "X", pitch);
  // 2 um sin(2 pi x / pitch + 0.5)
  const Eigen::Vector2d wave(2e-6 * std::cos(0.5), 2e-6 * std::sin(0.5));
  const RowVectorXd error =
      At(columns[0], 0, cause.id) * wave[0] + At(columns[1], 0, cause.id) * wave[1];
  for (Eigen::Index row = 0; row < 8; ++row) {
    const double x = ToAndFro().axes(0, row);
    EXPECT_NEAR(error[row], 2e-6 * std::sin(2.0 * std::numbers::pi * x / 4e-3 + 0.5), 1e-18);
  }
  const VectorXd keys = cause.ValuesOf(wave, pitch);
  EXPECT_NEAR(keys[0], 4e-3, 1e-15);
  EXPECT_NEAR(keys[1], 2e-6, 1e-15);
  EXPECT_NEAR(keys[2], 0.5, 1e-12);
}

TEST(Causes, ThermalGrowthGrowsWithWarmthAndPosition) {
  const RowVectorXd x = Only(ThermalGrowth(), "X temp_table_c", Positioning(0));
  EXPECT_NEAR(x[4], 0.4 * 4e-3, 1e-15);
  EXPECT_TRUE(ThermalGrowth().columns(ToAndFro(), "X temp_other_c", {}).empty());
}

TEST(Causes, LagIsBehindTheCommand) {
  EXPECT_NEAR(Only(ServoLag(), "X", Positioning(0))[2], -1e-3, 1e-15);
  EXPECT_NEAR(Only(ServoLag(), "X", Positioning(0))[6], 1e-3, 1e-15);
}

TEST(Causes, SpikeStaysBackAlongTheOldDirection) {
  const RowVectorXd x = Only(ReversalSpike(), "X", Positioning(0), VectorXd::Constant(1, 1e-3));
  EXPECT_NEAR(x[5], std::exp(-1.0), 1e-12);  // moving to -, hanging towards +
  EXPECT_NEAR(x[7], std::exp(-3.0), 1e-12);
}

TEST(Causes, CapDragsTheBallAgainstItsWay) {
  EXPECT_NEAR(Only(CapFriction(), "cap", kToolStage)[2], 1.0, 1e-12);  // the ball moves to -x
}

TEST(Causes, CapTrailsBehindTheMoreTheFaster) {
  // 60 mm/min, half of the most at 20 mm/min; the ball moves to -x.
  const VectorXd half = VectorXd::Constant(1, 20e-3 / 60.0);
  EXPECT_NEAR(Only(CapTrailing(), "cap", kToolStage, half)[2], 0.75, 1e-12);
}

TEST(Causes, EncoderOfAPivot) {
  EXPECT_NEAR(Only(JointHysteresis(), "pivot_1", kEncoderStage)[1], 0.5, 1e-12);
  const RowVectorXd step =
      Only(EncoderCountSlip(), "pivot_1", kEncoderStage, VectorXd::Constant(1, 4.0));
  EXPECT_EQ(step.head(4).norm(), 0.0);
  EXPECT_EQ(step.tail(4).sum(), 4.0);
  const auto columns = BearingRoundness().columns(ToAndFro(), "pivot_1", {});
  EXPECT_NEAR(columns[0].stages().at(kTipStage + 2)[3], std::sin(2.0 * 0.3), 1e-12);
  EXPECT_NEAR(columns[3].stages().at(kTipStage + 2)[3], std::cos(3.0 * 0.3), 1e-12);
}

TEST(Causes, AJointWithAGainShowsMoreInProportionToItsAngle) {
  Trace trace = ToAndFro();
  const Scene carried{{&trace}, Eigen::Vector3d::Constant(0.06)};
  EXPECT_TRUE(JointGain().objects(carried).empty());  // encoders on the pivots of a linkage
  EXPECT_TRUE(JointGain().columns(trace, "pivot_1", {}).empty());
  trace.kind = kArm;
  const Scene arm{{&trace}, Eigen::Vector3d::Zero()};
  EXPECT_EQ(JointGain().objects(arm), std::vector<std::string>{"pivot_1"});
  const auto columns = JointGain().columns(trace, "pivot_1", {});
  ASSERT_EQ(columns.size(), 1U);
  EXPECT_EQ(At(columns[0], kEncoderStage, "joint-gain"), RowVectorXd(trace.angles.row(0)));
}

TEST(Causes, AGainOfTheTrueGapIsToldFromWhatWasRead) {
  // Delta' = (1 + delta) Delta, so delta Delta = delta / (1 + delta) Delta'.
  const double delta = 0.02;
  const VectorXd found = VectorXd::Constant(1, delta / (1.0 + delta));
  EXPECT_NEAR(ProbeGain().ValuesOf(found, {})[0], delta, 1e-15);
}

// Coefficients of each cause, and one of its shapes; "tell" and back.
TEST(Causes, WhatIsToldCanBeRecalled) {
  const Trace trace = ToAndFro();
  const Scene scene{{&trace}, Eigen::Vector3d::Constant(0.06)};
  for (const Cause& cause : Causes()) {
    VectorXd coefficients = cause.plausible;
    for (Eigen::Index i = 0; i < coefficients.size(); ++i) coefficients[i] *= 1.0 + 0.5 * i;
    const VectorXd shape = cause.shapes ? cause.shapes(scene).front() : VectorXd();
    for (const double sign : {1.0, -1.0}) {
      if (cause.whole && sign < 0.0) continue;
      const VectorXd values = cause.ValuesOf(sign * coefficients, shape);
      ASSERT_EQ(values.size(), static_cast<Eigen::Index>(cause.keys.size())) << cause.id;
      const Recalled recalled = cause.RecallFrom(values);
      if (cause.drawn) {  // how large its draws are, not which
        EXPECT_EQ(recalled.shape[0], shape[0]) << cause.id;
        EXPECT_TRUE(recalled.coefficients.isZero(0.0)) << cause.id;
        continue;
      }
      EXPECT_LT((recalled.coefficients - sign * coefficients).norm(),
                1e-15 + 1e-12 * coefficients.norm())
          << cause.id;
      // The column of a cause that follows its size is taken around the size that was found.
      const VectorXd expected = cause.follows_size ? VectorXd(sign * coefficients) : shape;
      ASSERT_EQ(recalled.shape.size(), expected.size()) << cause.id;
      EXPECT_EQ(recalled.shape, expected) << cause.id;
    }
  }
}

TEST(Causes, APlausibleSizeIsInTheRangeOfItsKeys) {
  const Trace trace = ToAndFro();
  const Scene scene{{&trace}, Eigen::Vector3d::Constant(0.06)};
  for (const Cause& cause : Causes()) {
    for (const VectorXd& shape : cause.shapes ? cause.shapes(scene) : std::vector{VectorXd()}) {
      const VectorXd values = cause.ValuesOf(cause.plausible, shape);
      for (std::size_t i = 0; i < cause.keys.size(); ++i) {
        const CauseKey& key = cause.keys[i];
        const double value = values[static_cast<Eigen::Index>(i)] / key.unit;
        EXPECT_GE(value, key.least) << cause.id << " " << key.name;
        EXPECT_LE(value, key.most) << cause.id << " " << key.name;
      }
    }
  }
}

TEST(Causes, WhoDealsWithACauseIsToldByItsObject) {
  EXPECT_EQ(Backlash().SeatAt("X"), Seat::kMotion);
  EXPECT_EQ(ServoLagMismatch().SeatAt("XY"), Seat::kMotion);
  EXPECT_EQ(ThermalGrowth().SeatAt("X temp_table_c"), Seat::kMotion);
  EXPECT_EQ(WarmUpDrift().SeatAt("probe_a"), Seat::kInstrument);
  EXPECT_EQ(ClockSkew().SeatAt("linkage"), Seat::kInstrument);
  EXPECT_EQ(LeadscrewCyclic().SeatAt("Y"), Seat::kMap);
}

TEST(Causes, EachCauseExplainsItselfAndHasAName) {
  std::set<std::string> words;
  for (const Cause& cause : Causes()) {
    EXPECT_FALSE(cause.words.check.empty()) << cause.id;
    EXPECT_TRUE(cause.whole || !cause.keys.empty()) << cause.id;
    EXPECT_TRUE(cause.columns || cause.widens || cause.one_event) << cause.id;
    words.insert(cause.words.shows);
  }
  EXPECT_EQ(CauseNamed("cap-friction").id, "cap-friction");
  EXPECT_THAT([] { CauseNamed("backlush"); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("\"backlash\"")));
}

TEST(Heading, IgnoresTrembleAndFollowsTurns) {
  RowVectorXd x(9);
  x << 0.0, 0.1, 0.05, 1.0, 2.0, 1.95, 2.05, 1.0, 0.0;
  const RowVectorXd heading = HeadingOf(x, 0.2);
  EXPECT_EQ(heading, RowVectorXd((RowVectorXd(9) << 1, 1, 1, 1, 1, 1, 1, -1, -1).finished()));
}

}  // namespace causes_test
}  // namespace abbe::simulation
