// Each hidden effect of head, target and probes against its closed form: known steps of the gaps
// (the other axes by 45 um), tilts and standstills.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "rig/probe_runs.h"
#include "rig/record_sweep.h"
#include "tests/rig/hidden_worlds.h"

namespace abbe::rig {
namespace hidden_probes_test {

using Eigen::Vector3d;

constexpr double kStep = 45e-6;
constexpr double kRounding = 1e-14;  // m, of gaps that are differences of 0.1 m

ProbeRunOptions Short() {
  ProbeRunOptions options;
  options.rate = 100.0;
  options.stand = 0.05;
  options.places = 2;
  options.length = 20.0;
  return options;
}

// How the five gaps change from the start when the others step to (y, z), head as for X. The table
// carries y towards the side unit, the spindle z away from the target.
Readings ChangeAt(const std::vector<std::string>& hide, const Vector3d& step) {
  const World world(PerfectMachine(), 1, Hide(hide));
  const Readings before = world.ReadingsAt(0, Vector3d::Zero());
  Readings change = world.ReadingsAt(0, step);
  for (std::size_t i = 0; i < kProbes; ++i) change[i] -= before[i];
  return change;
}
const Vector3d kUp(0.0, 0.0, kStep), kAside(0.0, kStep, 0.0);

void ExpectChange(const Readings& change, const Readings& expected) {
  for (std::size_t i = 0; i < kProbes; ++i) EXPECT_NEAR(change[i], expected[i], kRounding) << i;
}

TEST(HiddenProbes, StepsAreSeenAsTheyAre) {
  ExpectChange(ChangeAt({}, kUp), {kStep, kStep, kStep, 0.0, 0.0});
  ExpectChange(ChangeAt({}, kAside), {0.0, 0.0, 0.0, -kStep, -kStep});
}

TEST(HiddenProbes, GainScalesWhatOneProbeSees) {
  ExpectChange(ChangeAt({"probe-gain:object=probe_b:delta=0.01"}, kUp),
               {kStep, 1.01 * kStep, kStep, 0.0, 0.0});
}

// The change that the catalogue knows is against the gap.
TEST(HiddenProbes, NonlinearityAddsTheSquareOfTheChange) {
  const double square = 2e3 * kStep * kStep;
  const std::vector<std::string> hide = {"probe-nonlinearity:object=probe_c:quadratic_per_mm=2"};
  ExpectChange(ChangeAt(hide, kUp), {kStep, kStep, kStep - square, 0.0, 0.0});
  ExpectChange(ChangeAt(hide, -kUp), {-kStep, -kStep, -kStep - square, 0.0, 0.0});
}

TEST(HiddenProbes, CrosstalkPutsTheSecondIntoTheFirst) {
  const std::vector<std::string> hide = {"probe-crosstalk:object=probe_a+probe_d:coefficient=0.02"};
  ExpectChange(ChangeAt(hide, kAside), {-0.02 * kStep, 0.0, 0.0, -kStep, -kStep});
  ExpectChange(ChangeAt(hide, kUp), {kStep, kStep, kStep, 0.0, 0.0});
}

TEST(HiddenProbes, SignTurnsTheChange) {
  ExpectChange(ChangeAt({"channel-sign:object=probe_d"}, kAside), {0.0, 0.0, 0.0, kStep, -kStep});
}

// The target's own tilt makes the gap depend on where the probe stands: the fitter sets the mean of
// the unit, so only differences within it count.
TEST(HiddenProbes, PositionMovesAProbeInItsPlane) {
  RigSettings settings = PerfectMachine();
  settings.target_tilt = 1e-3;
  const auto gaps = [&](const std::vector<std::string>& hide) {
    return World(settings, 4, Hide(hide)).TrueGaps(0, Vector3d::Zero());
  };
  const Vector3d tilt = World(settings, 4).target().tilt;  // about x, y, z
  const Readings before = gaps({});
  const Readings after = gaps({"probe-position:object=probe_a:du_mm=0.2:dv_mm=0",
                               "probe-position:object=probe_e:du_mm=0:dv_mm=0.3"});
  // The normal of a face z is (tilt y, -tilt x, 1), of a face y (-tilt z, 1, tilt x); 1e-3 of it
  // second order.
  EXPECT_NEAR((after[0] - after[1]) - (before[0] - before[1]), 0.2e-3 * tilt.y(), 1e-9);
  EXPECT_NEAR((after[4] - after[3]) - (before[4] - before[3]), 0.3e-3 * tilt.x(), 1e-9);
  EXPECT_GT(std::abs(0.2e-3 * tilt.y()), 1e-8);
  EXPECT_GT(std::abs(0.3e-3 * tilt.x()), 1e-8);
}

TEST(HiddenProbes, MisalignmentTurnsTheHead) {
  const World world(PerfectMachine(), 1,
                    Hide({"fixture-misalignment:object=head:roll_urad=1000:pitch_urad=2000:"
                          "yaw_urad=3000:du_mm=0:ds_mm=0:dn_mm=0"}));
  const Readings gaps = world.TrueGaps(0, Vector3d::Zero());
  // About u, s, n: b stands at s = 10, c at -10, a and e at u = 10 mm. Second order: 6e-6 of 10 mm.
  EXPECT_NEAR(gaps[1] - gaps[2], 1000e-6 * 0.02, 1e-7);
  EXPECT_NEAR(gaps[0] - 0.5 * (gaps[1] + gaps[2]), -2000e-6 * 0.01, 1e-7);
  EXPECT_NEAR(gaps[4] - gaps[3], 3000e-6 * 0.01, 1e-7);
}

TEST(HiddenProbes, ATiltedElectrodeReadsLess) {
  RigSettings settings = PerfectMachine();
  settings.target_tilt = 5e-3;
  const World world(settings, 2, Hide({"probe-tilt-response:object=head:electrode_radius_mm=4"}));
  const double tilt = std::hypot(world.target().tilt.x(), world.target().tilt.y());
  const double gap = world.TrueGaps(0, Vector3d::Zero())[0];
  const double share = 4e-3 * tilt / gap;
  ASSERT_LT(share, 1.0);
  // sin of the tilt for the tilt: 1e-5 of what it does.
  EXPECT_NEAR(world.ReadingsAt(0, Vector3d::Zero())[0],
              0.5 * gap * (1.0 + std::sqrt(1.0 - share * share)), 1e-10);
}

// The form of a face as probe b sees it while X carries the target by.
std::vector<double> Profile(const Mounting& mounting, int probe, double from, double sign) {
  const World world(PerfectMachine(), 3, Hide({"target-form:object=target_top:rms_um=0.4"}),
                    mounting);
  std::vector<double> profile;
  for (int i = 0; i <= 10; ++i) {
    profile.push_back(world.TrueGaps(0, {from + sign * 4e-3 * i, 0.0, 0.0})[probe]);
    if (i > 0) profile[i] -= profile[0];
  }
  return profile;
}

TEST(HiddenProbes, FormFollowsTheTargetWhenItIsShiftedOrReversed) {
  const auto form = Profile({}, 1, 0.003, 1.0);
  const auto shifted = Profile({.target_shift = 3e-3}, 1, 0.0, 1.0);
  // End for end about the middle of 60 mm, b at +10 mm comes to where c was at -10.
  const auto back = Profile({.target_reversed = true}, 1, 0.060, -1.0);
  const auto other = Profile({}, 2, 0.0, 1.0);
  double largest = 0.0;
  for (std::size_t i = 1; i < form.size(); ++i) {
    EXPECT_NEAR(shifted[i], form[i], kRounding);
    EXPECT_NEAR(back[i], other[i], kRounding);
    largest = std::max(largest, std::abs(form[i]));
  }
  EXPECT_GT(largest, 0.1e-6);
}

TEST(HiddenProbes, TheOtherFaceKeepsItsForm) {
  const World world(PerfectMachine(), 3, Hide({"target-form:object=target_top:rms_um=0.4"}));
  EXPECT_NEAR(world.TrueGaps(0, {0.02, 0.0, 0.0})[3], 100e-6, kRounding);
}

TEST(HiddenProbes, AHeadTurnedByHalfATurnLooksAtTheOtherSide) {
  const World world(PerfectMachine(), 1, {}, {.number = 2, .head_turned = true});
  const Readings before = world.ReadingsAt(0, Vector3d::Zero()), up = world.ReadingsAt(0, kUp),
                 aside = world.ReadingsAt(0, kAside);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(up[i] - before[i], kStep, kRounding);
  for (std::size_t i = 3; i < 5; ++i) EXPECT_NEAR(aside[i] - before[i], kStep, kRounding);
}

TEST(HiddenProbes, AnotherMountingIsAnotherTiltOfTheSameTarget) {
  RigSettings settings = PerfectMachine();
  settings.target_tilt = 1e-3;
  settings.u_target_squareness = 1e-5;
  settings.installation_angle = 1e-3;
  const World first(settings, 5), second(settings, 5, {}, {.number = 1});
  EXPECT_NE(first.target().tilt, second.target().tilt);
  EXPECT_EQ(first.target().squareness, second.target().squareness);
  EXPECT_NE(first.InstallationOf(1).angles, second.InstallationOf(1).angles);
}

recording::Recording Dwell(const std::vector<std::string>& hide, double begin = 0.0) {
  ProbeRunOptions options = Short();
  options.begin = begin;
  return RecordDwell(World(PerfectMachine(), 1, Hide(hide)), 'X', nullptr, options);
}

// Every 93 ms the phase goes on by 4.65 turns and what the mains has gained on the clock.
TEST(HiddenProbes, PickUpIsALineInTimeThatADwellDoesNotMiss) {
  const auto dwell = Dwell({"mains-pickup:object=probe_a:frequency_hz=50:amplitude_um=0.2"}, 20.0);
  const double turn = 2.0 * std::numbers::pi * 0.35;
  double most = 0.0;
  for (std::size_t i = 2; i < dwell.rows(); ++i) {
    const auto& gap = dwell.At("probe_a_um");
    const double next = 2.0 * std::cos(turn) * (gap[i - 1] - 100.0) - (gap[i - 2] - 100.0);
    EXPECT_NEAR(gap[i] - 100.0, next, 0.2 * 4.0 * 2.0 * std::numbers::pi * 30e-3 * 0.093);
    EXPECT_NEAR(dwell.At("probe_b_um")[i], 100.0, 1e-8);
    most = std::max(most, std::abs(gap[i] - 100.0));
  }
  EXPECT_GT(most, 0.15);  // no alias to nothing
  EXPECT_LT(most, 0.2 + 1e-8);
  EXPECT_EQ(dwell.Kind(), "dwell");
  EXPECT_EQ(dwell.At("direction")[0], 0.0);
  EXPECT_DOUBLE_EQ(dwell.At("time_s")[1], 0.093);
}

TEST(HiddenProbes, AChannelWarmsUp) {
  const auto dwell =
      Dwell({"warm-up-drift:object=probe_e:amplitude_um=0.5:time_constant_s=400"}, 100.0);
  for (std::size_t i = 0; i < dwell.rows(); ++i) {
    const double time = 100.0 + dwell.At("time_s")[i];
    EXPECT_NEAR(dwell.At("probe_e_um")[i] - 100.0, 0.5 * (1.0 - std::exp(-time / 400.0)), 1e-8);
  }
}

TEST(HiddenProbes, HumAndAStepThatComesBackAreNoCauses) {
  const auto dwell = Dwell({"unknown-hum:object=probe_a:amplitude_um=0.2:period_s=40:phase_rad=0",
                            "unknown-step-and-back:object=probe_b:height_um=0.7:from_s=5:to_s=9"});
  for (std::size_t i = 0; i < dwell.rows(); ++i) {
    const double time = dwell.At("time_s")[i];
    EXPECT_NEAR(dwell.At("probe_a_um")[i] - 100.0,
                0.2 * std::sin(2.0 * std::numbers::pi * time / 40.0), 1e-8);
    EXPECT_NEAR(dwell.At("probe_b_um")[i] - 100.0, time >= 5.0 && time < 9.0 ? 0.7 : 0.0, 1e-8);
  }
}

TEST(HiddenProbes, AReadingCanFollowTheSquareOfATemperature) {
  RigSettings settings = PerfectMachine();
  Climate climate(settings, 1, 3, {"temp_column_c"});
  climate.Warm(3.0);
  ProbeRunOptions options = Short();
  options.climate = &climate;
  const World world(settings, 1, Hide({"unknown-warmth-square:object=probe_a:height_um=0.2"}));
  const auto dwell = RecordDwell(world, 'X', nullptr, options);
  EXPECT_NEAR(dwell.At("probe_a_um")[5], 100.0 + 0.2 * 9.0, 1e-8);
}

// Only the axis that is not swept is felt.
TEST(HiddenProbes, AnIdleAxisCanBeFelt) {
  const World world(PerfectMachine(), 1,
                    Hide({"unknown-idle-axis:object=probe_a:axis=2:amplitude_um=1:period_mm=0.2"}));
  const auto steps = RecordGapSteps(world, 'X', Short());
  double most = 0.0;
  for (std::size_t i = 0; i < steps.rows(); ++i) {
    const double y = steps.At("y_mm")[i], z = steps.At("z_mm")[i];
    const double felt = std::sin(2.0 * std::numbers::pi * y / 0.2);
    EXPECT_NEAR(steps.At("probe_a_um")[i], 100.0 + 1e3 * z + felt, 1e-6);
    most = std::max(most, felt);
  }
  EXPECT_GT(most, 0.9);
}

TEST(HiddenProbes, GapStepsStandAtEachStepOfTheOtherAxes) {
  const auto steps = RecordGapSteps(World(PerfectMachine(), 1), 'Y', Short());
  EXPECT_EQ(steps.Kind(), "gap-steps");
  EXPECT_EQ(steps.HeaderText("axis"), "Y");
  std::map<std::pair<int, int>, int> rows;  // of (z, x) in steps
  for (std::size_t i = 0; i < steps.rows(); ++i) {
    const double x = 1e3 * steps.At("x_mm")[i] / 45.0, z = 1e3 * steps.At("z_mm")[i] / 45.0;
    // Standing is within 0.1 um.
    EXPECT_NEAR(x, std::round(x), 0.003);
    EXPECT_NEAR(z, std::round(z), 0.003);
    ++rows[{static_cast<int>(std::round(z)), static_cast<int>(std::round(x))}];
  }
  ASSERT_EQ(rows.size(), 5U);
  for (const auto& place : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) EXPECT_GE(rows[place], 8);
}

TEST(HiddenProbes, SwappedCablesExchangeTwoColumns) {
  const auto steps = RecordGapSteps(
      World(PerfectMachine(), 1, Hide({"channel-swap:object=probe_a+probe_d"})), 'X', Short());
  const auto plain = RecordGapSteps(World(PerfectMachine(), 1), 'X', Short());
  for (std::size_t i = 0; i < steps.rows(); ++i) {
    EXPECT_EQ(steps.At("probe_a_um")[i], plain.At("probe_d_um")[i]);
    EXPECT_EQ(steps.At("probe_d_um")[i], plain.At("probe_a_um")[i]);
    EXPECT_EQ(steps.At("probe_b_um")[i], plain.At("probe_b_um")[i]);
  }
}

TEST(HiddenProbes, DataCanBeStuckOrJump) {
  RigSettings settings = PerfectMachine();
  settings.white = 20e-9;
  HiddenEffects hidden =
      Hide({"stuck-channel:object=probe_b:from_s=4:to_s=8", "outliers:object=probe_c:count=7"});
  SetInTime(hidden, {{0.0, 20.0, true, false}});
  const auto said = RecordDwell(World(settings, 1, hidden), 'X', nullptr, Short());
  const auto plain = RecordDwell(World(settings, 1), 'X', nullptr, Short());
  int jumps = 0;
  for (std::size_t i = 0; i < said.rows(); ++i) {
    const double time = said.At("time_s")[i];
    const bool stuck = time >= 4.0 && time < 8.0;
    if (stuck && i > 0 && said.At("time_s")[i - 1] >= 4.0) {
      EXPECT_EQ(said.At("probe_b_um")[i], said.At("probe_b_um")[i - 1]);
    } else {
      EXPECT_EQ(said.At("probe_b_um")[i], plain.At("probe_b_um")[i]);
    }
    const double off = std::abs(said.At("probe_c_um")[i] - plain.At("probe_c_um")[i]);
    if (off > 1e-9) {
      ++jumps;
      EXPECT_GE(off, 1.0);
      EXPECT_LE(off, 10.0);
    }
  }
  EXPECT_EQ(jumps, 7);
}

// While the axis cruises at 10 mm/s past a tilted target, late stamps show where it was.
TEST(HiddenProbes, LateProbesShowWhereTheAxisWas) {
  RigSettings settings = PerfectMachine();
  settings.target_tilt = 1e-3;
  settings.sweeps[0]->stations = {0.0, 0.03, 0.06};
  settings.sweeps[0]->passes = 1;
  const std::vector<hal::Channel> channels = {{"probe_a_um", "head"}};
  const auto sweep = [&](const HiddenEffects& hidden) {
    return RecordSweep(World(settings, 2, hidden), 'X', channels, {.rate = 50.0});
  };
  const auto late = sweep(Hide({"clock-skew:object=probes:delay_ms=8"})), plain = sweep({});
  const double slope = World(settings, 2).target().tilt.y();  // of gap over place on the face
  ASSERT_GT(std::abs(slope), 1e-4);
  int cruising = 0;
  for (std::size_t i = 1; i < late.rows(); ++i) {
    const double off = late.At("probe_a_um")[i] - plain.At("probe_a_um")[i];
    const double speed = (late.At("x_mm")[i] - late.At("x_mm")[i - 1]) * 50.0;  // mm/s
    if (std::abs(std::abs(speed) - 10.0) > 1e-6) continue;
    ++cruising;
    // The gap over x is -slope: the target goes on under the probe.
    EXPECT_NEAR(off, slope * 8e-3 * speed * 1e3, 2e-3 * std::abs(off) + 1e-6);
  }
  EXPECT_GT(cruising, 100);
}

}  // namespace hidden_probes_test
}  // namespace abbe::rig
