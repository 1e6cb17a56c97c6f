// What each cause does, against its definition by hand on a short path.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "failure/failure.h"
#include "settings/unit.h"
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
  trace.since_reversal = Eigen::Matrix3Xd::Constant(3, kRows, kLongAgo);
  trace.since_reversal.row(0).tail(3) << 1e-3, 2e-3, 3e-3;
  trace.linkage.emplace();
  trace.linkage->cap_direction = -trace.heading;  // a table
  trace.linkage->angles = trace.axes.topRows(1) * 100.0;
  trace.linkage->heading = trace.heading.topRows(1);
  trace.linkage->link = Eigen::MatrixXd::Zero(3, kRows);
  trace.linkage->link.row(2).setOnes();
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
  // Anywhere between two readings, one second apart.
  const Trace read = ToAndFro();
  const double u = EncoderCountSlip().shape_spread({{&read}, {}}, VectorXd::Constant(1, 3.5));
  EXPECT_NEAR(u, 1.0 / std::sqrt(12.0), 1e-12);
  const auto columns = BearingRoundness().columns(ToAndFro(), "pivot_1", {});
  EXPECT_NEAR(columns[0].stages().at(kTipStage + 2)[3], std::sin(2.0 * 0.3), 1e-12);
  EXPECT_NEAR(columns[3].stages().at(kTipStage + 2)[3], std::cos(3.0 * 0.3), 1e-12);
}

TEST(Causes, AJointWithAGainShowsMoreInProportionToItsAngle) {
  Trace trace = ToAndFro();
  const Scene carried{{&trace}, Eigen::Vector3d::Constant(0.06)};
  EXPECT_TRUE(JointGain().objects(carried).empty());  // encoders on the pivots of a linkage
  EXPECT_TRUE(JointGain().columns(trace, "pivot_1", {}).empty());
  trace.linkage->is_arm = true;
  const Scene arm{{&trace}, Eigen::Vector3d::Zero()};
  EXPECT_EQ(JointGain().objects(arm), std::vector<Object>{"pivot_1"});
  const auto columns = JointGain().columns(trace, "pivot_1", {});
  ASSERT_EQ(columns.size(), 1U);
  EXPECT_EQ(At(columns[0], kEncoderStage, "joint-gain"), RowVectorXd(trace.linkage->angles.row(0)));
}

// What was read stays behind what was sent; there is one share for all joints.
TEST(Causes, AnglesReadTooEarlyAreBehindTheCommandedOnes) {
  Trace trace = ToAndFro();
  trace.linkage->is_arm = true;
  const Scene unknown{{&trace}, Eigen::Vector3d::Zero()};
  EXPECT_TRUE(LateReading().objects(unknown).empty());
  trace.linkage->behind.setConstant(1, trace.rows(), -2e-3);
  EXPECT_EQ(LateReading().objects(unknown), std::vector<Object>{"arm"});
  const auto columns = LateReading().columns(trace, "arm", {});
  ASSERT_EQ(columns.size(), 1U);
  EXPECT_TRUE(At(columns[0], kEncoderStage, "late-reading").isApproxToConstant(-2e-3, 1e-9));
}

TEST(Causes, AnArmDriftsAlongThreeDirectionsAsItWarmsUp) {
  Trace trace = ToAndFro();
  EXPECT_TRUE(ArmDrift().columns(trace, "arm", VectorXd::Constant(1, 4.0)).empty());
  trace.linkage->is_arm = true;
  const auto columns = ArmDrift().columns(trace, "arm", VectorXd::Constant(1, 4.0));
  ASSERT_EQ(columns.size(), 3U);
  for (int k = 0; k < 3; ++k) {
    const RowVectorXd& moved = columns[static_cast<std::size_t>(k)].stages().at(kTipStage + k);
    EXPECT_NEAR(moved[4], 1.0 - std::exp(-trace.clock[4] / 4.0), 1e-12);
  }
}

TEST(Causes, AGainOfTheTrueGapIsToldFromWhatWasRead) {
  // Delta' = (1 + delta) Delta, so delta Delta = delta / (1 + delta) Delta'.
  const double delta = 0.02;
  const VectorXd found = VectorXd::Constant(1, delta / (1.0 + delta));
  EXPECT_NEAR(ProbeGain().ValuesOf(found, {})[0], delta, 1e-15);
}

// Nobody knows the phase of the mains, nor on which side of its play an axis stands.
TEST(Causes, RunsHaveMainsAndStandingPositionsOfTheirOwn) {
  Trace first = ToAndFro(), second = ToAndFro();
  for (Trace* trace : {&first, &second}) {
    trace->head.emplace();
    trace->time *= 5.0;
  }
  first.started = 1000.0;
  second.started = 2000.0;
  const Scene scene{{&first, &second}, Eigen::Vector3d::Constant(0.06)};
  for (const auto& [cause, object] :
       {std::pair{MainsPickup(), "probe_b"}, {StandingPosition(), "Y"}}) {
    const VectorXd shape = cause.ShapesFor(scene, object).front();
    const auto in_first = cause.columns(first, object, shape);
    const auto in_second = cause.columns(second, object, shape);
    int used = 0;
    for (std::size_t i = 0; i < in_first.size(); ++i) {
      EXPECT_TRUE(in_first[i].stages().empty() || in_second[i].stages().empty()) << cause.id;
      used += in_first[i].stages().empty() ? 0 : 1;
    }
    EXPECT_EQ(used, cause.id == "mains-pickup" ? 10 : 1);  // nodes 8.75 s apart over 35 s
  }
  // X stands in the first row alone.
  const auto until_it_moves =
      StandingPosition().columns(first, "X", StandingPosition().ShapesFor(scene, "X").front());
  const RowVectorXd x = At(until_it_moves.front(), Positioning(0), "standing-position");
  EXPECT_EQ(x[0], 1.0);
  EXPECT_TRUE(x.tail(x.size() - 1).isZero(0.0));
}

// From the top of a circle a slow axis is followed back far in time, and not far in angle.
TEST(Causes, AReversalBeforeTheFirstRowOfACircleIsKnown) {
  constexpr double kRadius = 20e-3, kRate = 0.1;  // m, rad/s
  for (const auto& [angle, is_known] : {std::pair{0.3, true}, {0.9, false}}) {
    Trace trace;
    constexpr Eigen::Index kRows = 40;
    trace.time = trace.clock = VectorXd::LinSpaced(kRows, 0.0, 3.9);
    trace.pass.assign(kRows, 1);
    trace.direction.assign(kRows, 1);
    const Eigen::ArrayXd at = angle + kRate * trace.time.array();
    Eigen::Matrix3Xd path = Eigen::Matrix3Xd::Zero(3, kRows);
    path.row(0) = kRadius * at.cos();
    path.row(1) = kRadius * at.sin();
    trace.SetAxes(path);
    const double truth = is_known ? kRadius * (1.0 - std::cos(angle)) : kLongAgo;
    EXPECT_NEAR(trace.since_reversal(0, 0), truth, 0.03 * truth);
    EXPECT_EQ(trace.since_reversal(1, 0), kLongAgo);
  }
}

// Coefficients of each cause, and one of its shapes; "tell" and back.
TEST(Causes, WhatIsToldCanBeRecalled) {
  const Trace trace = ToAndFro();
  const Scene scene{{&trace}, Eigen::Vector3d::Constant(0.06)};
  for (const Cause& cause : Causes()) {
    VectorXd coefficients = cause.plausible;
    for (Eigen::Index i = 0; i < coefficients.size(); ++i) coefficients[i] *= 1.0 + 0.5 * i;
    const VectorXd shape = cause.ShapesFor(scene, "X").front();
    for (const double sign : {1.0, -1.0}) {
      if (cause.IsBinary() && sign < 0.0) continue;
      const VectorXd values = cause.ValuesOf(sign * coefficients, shape);
      ASSERT_EQ(values.size(), static_cast<Eigen::Index>(cause.keys.size())) << cause.id;
      const Recalled recalled = cause.RecallFrom(values);
      if (cause.IsRandomField()) {  // how large its draws are, not which
        EXPECT_DOUBLE_EQ(recalled.shape[0], shape[0]) << cause.id;
        EXPECT_TRUE(recalled.coefficients.isZero(0.0)) << cause.id;
        continue;
      }
      EXPECT_LT((recalled.coefficients - sign * coefficients).norm(),
                1e-15 + 1e-12 * coefficients.norm())
          << cause.id;
      // The column of a cause that follows its size is taken around the size that was found.
      VectorXd expected = shape;
      if (cause.FollowsItsSize()) {
        expected.conservativeResize(std::max(shape.size(), coefficients.size()));
        expected.tail(coefficients.size()) = sign * coefficients;
      }
      ASSERT_EQ(recalled.shape.size(), expected.size()) << cause.id;
      EXPECT_EQ(recalled.shape, expected) << cause.id;
    }
  }
}

// Several shapes of such a cause may fit alike; the text names each by the value of that key
// (diagnosis/alias_group.h).
TEST(Causes, ShapesThatOthersMayLookLikeAreKeys) {
  for (const Cause& cause : Causes()) {
    const bool tried = cause.shapes && cause.fixed_shapes && !cause.IsRandomField();
    if (!cause.wave && !tried) continue;
    EXPECT_TRUE(cause.KeyOfShape()) << cause.id;
  }
  const Cause& slip = CauseNamed("encoder-count-slip");
  EXPECT_EQ(slip.keys.at(slip.KeyOfShape().value()).name, "time_s");
  EXPECT_FALSE(CauseNamed("backlash").KeyOfShape());
}

TEST(Causes, APlausibleSizeIsInTheRangeOfItsKeys) {
  const Trace trace = ToAndFro();
  const Scene scene{{&trace}, Eigen::Vector3d::Constant(0.06)};
  for (const Cause& cause : Causes()) {
    for (const VectorXd& shape : cause.ShapesFor(scene, "X")) {
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
  EXPECT_EQ(Backlash().CorrectedAt("X"), CorrectedBy::kMotion);
  EXPECT_EQ(ServoLagMismatch().CorrectedAt("XY"), CorrectedBy::kMotion);
  EXPECT_EQ(ThermalGrowth().CorrectedAt("X temp_table_c"), CorrectedBy::kMotion);
  EXPECT_EQ(WarmUpDrift().CorrectedAt("probe_a"), CorrectedBy::kInstrument);
  EXPECT_EQ(ClockSkew().CorrectedAt("linkage"), CorrectedBy::kInstrument);
  EXPECT_EQ(LeadscrewCyclic().CorrectedAt("Y"), CorrectedBy::kMap);
}

// A recording of everything at once: sweep, pivots and temperatures, or a turning shaft.
Trace Recorded(bool of_shaft) {
  Trace trace = ToAndFro();
  const Eigen::Index rows = trace.rows();
  trace.linkage->is_arm = true;
  trace.linkage->behind = 1e-3 * trace.linkage->angles;
  trace.axis = 'X';
  trace.temperature = trace.warming;
  trace.pass.assign(static_cast<std::size_t>(rows), 1);
  trace.direction.assign(static_cast<std::size_t>(rows), 1);
  trace.acceleration = 1e-3 * trace.axes;
  if (of_shaft) {
    trace.rim.emplace();
    trace.rim->sensors = 2;
    for (int row = 0; row < rows; ++row) trace.rim->sensor.push_back(row % 2);
    trace.rim->shaft = RowVectorXd::LinSpaced(rows, 0.0, 5.0);
    trace.rim->place = RowVectorXd::Constant(rows, 0.4);
    trace.rim->seen = trace.rim->by_angle = trace.rim->by_angle_twice =
        trace.rim->shaft.array().sin();
    trace.rim->slope = RowVectorXd::Ones(rows);
    return trace;
  }
  trace.head.emplace();
  trace.head->gap = Eigen::MatrixXd::Random(5, rows);
  trace.head->zero.setOnes();
  trace.head->tilt = Eigen::MatrixXd::Random(5, rows);
  trace.head->spots = 0.01 * Eigen::MatrixXd::Random(10, rows);
  return trace;
}

bool Same(const std::vector<Disturbance>& one, const std::vector<Disturbance>& other) {
  constexpr double kRounding = 1e-9;
  EXPECT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    const auto &a = one[i].stages(), &b = other[i].stages();
    EXPECT_EQ(a.size(), b.size());
    for (const auto& [stage, values] : a) {
      if (!(values - b.at(stage)).isZero(kRounding * (1.0 + values.norm()))) return false;
    }
  }
  return true;
}

// The same way an hour later is the same to a cause unless it follows time, and in another warmth
// unless it follows a temperature: in all columns of all causes on all that they can be of.
TEST(Causes, FollowsWhatTheySayThatTheyFollow) {
  std::set<const Cause*> seen;
  for (const bool of_shaft : {false, true}) {
    const Trace trace = Recorded(of_shaft);
    Trace later = trace, warmer = trace;
    later.time.array() += 3600.123;
    later.clock.array() += 3600.123;
    warmer.temperature.array() += 3.0;
    warmer.warming.array() += 3.0;
    const Scene scene{{&trace}, Eigen::Vector3d::Constant(0.06)};
    for (const Cause& cause : Causes()) {
      const auto objects = cause.objects(scene);
      if (!cause.columns || objects.empty()) continue;
      const VectorXd shape = cause.ShapesFor(scene, "X").back();
      bool is_seen = false, by_time = false, by_warmth = false;
      for (const Object& object : objects) {
        const auto columns = cause.columns(trace, object, shape);
        if (columns.empty()) continue;
        is_seen = true;
        by_time = by_time || !Same(columns, cause.columns(later, object, shape));
        by_warmth = by_warmth || !Same(columns, cause.columns(warmer, object, shape));
      }
      if (!is_seen) continue;
      seen.insert(&cause);
      EXPECT_EQ(by_time, cause.follows == Follows::kTime) << cause.id;
      EXPECT_EQ(by_warmth, cause.follows == Follows::kTemperature) << cause.id;
    }
  }
  Trace linkage = Recorded(false);
  linkage.linkage->angles = linkage.linkage->angles.replicate(3, 1).eval();
  const Scene arm{{&linkage}, Eigen::Vector3d::Constant(0.06)};
  Trace on_machine = linkage;
  on_machine.linkage->is_arm = false;
  const Scene carried{{&on_machine}, Eigen::Vector3d::Constant(0.06)};
  for (const Cause& cause : Causes()) {
    if (cause.columns) {
      EXPECT_TRUE(seen.contains(&cause)) << cause.id << " has no columns here";
    } else if (cause.relaxes) {  // follows what the parameter that it sets free does
      auto objects = cause.objects(carried);
      if (objects.empty()) objects = cause.objects(arm);
      ASSERT_FALSE(objects.empty()) << cause.id;
      const auto widened = cause.relaxes(objects.front());
      const bool is_warm = !widened.empty() && widened.front().starts_with("expansion.");
      EXPECT_EQ(cause.follows == Follows::kTemperature, is_warm) << cause.id;
    } else {  // invalid readings
      EXPECT_EQ(cause.follows, Follows::kTime) << cause.id;
    }
  }
}

// A file, a result and the page take the unit from the end of the name (settings/unit.h), the fit
// from CauseKey::unit.
TEST(Causes, TheNameOfEachKeySaysItsUnit) {
  const std::set<std::string_view> plain{"delta", "coefficient", "order", "count", "share"};
  for (const Cause& cause : Causes()) {
    for (const CauseKey& key : cause.keys) {
      const settings::Unit unit = settings::UnitOf(key.name);
      EXPECT_DOUBLE_EQ(unit.si, key.unit) << cause.id << " " << key.name;
      EXPECT_EQ(unit.name.empty(), plain.contains(key.name)) << cause.id << " " << key.name;
    }
  }
}

TEST(Causes, EachCauseExplainsItselfAndHasAName) {
  std::set<std::string> words;
  for (const Cause& cause : Causes()) {
    EXPECT_FALSE(cause.words.check.empty()) << cause.id;
    EXPECT_TRUE(cause.IsBinary() || !cause.keys.empty()) << cause.id;
    EXPECT_TRUE(cause.columns || cause.relaxes || cause.one_event) << cause.id;
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
