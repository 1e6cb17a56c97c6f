#include "probes/squareness_of_sweeps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"
#include "probes/sweep_reduction.h"
#include "tests/probes/synthetic_sweep.h"

namespace abbe::probes {
namespace squareness_of_sweeps_test {

constexpr char kMounting[] = "[mounting]\nid = \"A17\"\n";  // as abbe sweep writes it

// A straight motion whose direction leans by these slopes along s and n of the head frame, seen on
// a target whose faces are turned with `tilt` (a rotation vector in M).
recording::Recording LeanSweep(const SweepSetup& setup, char axis, double slope_s, double slope_n,
                               const Eigen::Vector3d& tilt, const std::string& header = kMounting) {
  SyntheticSweep sweep;
  sweep.axis = axis;
  sweep.moving = axis == 'Z' ? MovingBody::kHead : MovingBody::kTarget;
  sweep.header = header;
  const Eigen::Vector3d in_head = setup.head.Frame(axis).R_MH.transpose() * tilt;
  sweep.tilt_s = in_head.y();
  sweep.tilt_n = in_head.z();
  sweep.errors = [=](double d, int) {
    HeadErrors<> e;
    e.eyx = slope_s * d;
    e.ezx = slope_n * d;
    return e;
  };
  return Record(sweep, setup);
}

SweepResult Lean(const SweepSetup& setup, char axis, double slope_s, double slope_n,
                 const Eigen::Vector3d& tilt, const std::string& header = kMounting) {
  return ReduceSweep(LeanSweep(setup, axis, slope_s, slope_n, tilt, header), setup);
}

// What a control that counts X and Y the other way would have recorded.
recording::Recording CountedTheOtherWay(recording::Recording sweep, bool swept) {
  for (recording::Column& column : sweep.columns) {
    const bool turned =
        column.name == "x_mm" || column.name == "y_mm" || (swept && column.name == "direction");
    if (!turned) continue;
    for (double& value : column.values) value = -value;
  }
  return sweep;
}

// The directions of motion: X = (1, a, b), Y = (c, 1, d), Z = (e, f, 1).
constexpr double kA = 10e-6, kB = -20e-6, kC = 35e-6, kD = 5e-6, kE = -40e-6, kF = 15e-6;
constexpr double kRounding = 1e-10;  // rad: tilts of 0.2 mrad times errors of 40 urad, second order

// In the head frames of X (x, y, z), Y (y, -x, z), Z (z, y, -x).
SweepResult SweepOfX(const SweepSetup& setup, const Eigen::Vector3d& tilt) {
  return Lean(setup, 'X', kA, kB, tilt);
}
SweepResult SweepOfY(const SweepSetup& setup, const Eigen::Vector3d& tilt) {
  return Lean(setup, 'Y', -kC, kD, tilt);
}
SweepResult SweepOfZ(const SweepSetup& setup, const Eigen::Vector3d& tilt) {
  return Lean(setup, 'Z', kF, -kE, tilt);
}

// Inclinations are those of the carriages in the machine, not of the numbers.
TEST(SquarenessOfSweeps, IsTheSameWhicheverWayTheControlCounts) {
  const SweepSetup setup = TestSetup();
  SweepSetup counted = setup;
  counted.machine.chain.ReadPositive("tool", "");
  for (const int axis : {0, 1}) {  // the same places by the other numbers
    machine::Travel& travel = counted.machine.travels[static_cast<std::size_t>(axis)];
    travel = {-travel.last, -travel.first};
  }
  const Eigen::Vector3d tilt(150e-6, -80e-6, 200e-6);
  const auto reduced = [&](char axis, double s, double n) {
    return ReduceSweep(CountedTheOtherWay(LeanSweep(setup, axis, s, n, tilt), axis != 'Z'),
                       counted);
  };
  const SweepResult x = reduced('X', kA, kB), y = reduced('Y', -kC, kD), z = reduced('Z', kF, -kE);
  EXPECT_EQ(x.positive, "tool");
  EXPECT_LT(x.stations.front(), 0.0);
  EXPECT_NEAR(SquarenessOfSweeps(x, y, setup.target).value, -kA - kC, kRounding);
  EXPECT_NEAR(SquarenessOfSweeps(x, z, setup.target).value,
              SquarenessOfSweeps(SweepOfX(setup, tilt), SweepOfZ(setup, tilt), setup.target).value,
              kRounding);
  EXPECT_NEAR(SquarenessOfSweeps(y, z, setup.target).value,
              SquarenessOfSweeps(SweepOfY(setup, tilt), SweepOfZ(setup, tilt), setup.target).value,
              kRounding);
}

// By definition: the angle between the directions, less a right angle, and the tilt of the target
// plays no part.
TEST(SquarenessOfSweeps, IsTheAngleBetweenTheMotionsWhateverTheTargetsTilt) {
  const SweepSetup setup = TestSetup();
  for (const Eigen::Vector3d& tilt :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(150e-6, -80e-6, 200e-6)}) {
    const SweepResult x = SweepOfX(setup, tilt), y = SweepOfY(setup, tilt),
                      z = SweepOfZ(setup, tilt);
    const SquarenessResult c0y = SquarenessOfSweeps(x, y, setup.target);
    EXPECT_EQ(c0y.name, "C0Y");
    EXPECT_NEAR(c0y.value, -kA - kC, kRounding);  // cos of the angle is a + c: wider by -(a + c)
    const SquarenessResult b0z = SquarenessOfSweeps(z, x, setup.target);
    EXPECT_EQ(b0z.name, "B0Z");
    EXPECT_NEAR(b0z.value, kB + kE, kRounding);
    const SquarenessResult a0z = SquarenessOfSweeps(y, z, setup.target);
    EXPECT_EQ(a0z.name, "A0Z");
    EXPECT_NEAR(a0z.value, -kD - kF, kRounding);
    EXPECT_GE(a0z.u, 2e-6);
    EXPECT_NEAR(a0z.u, std::hypot(a0z.u_slopes, 2e-6), 1e-12);
  }
}

TEST(SquarenessOfSweeps, TheTargetsOwnSquarenessIsAdded) {
  SweepSetup setup = TestSetup();
  const Eigen::Vector3d level = Eigen::Vector3d::Zero();
  setup.target.squareness = 12e-6;
  // The face that the Y sweep looks at is turned by 12 urad about z from square.
  const SweepResult x = SweepOfX(setup, level);
  const SweepResult y = SweepOfY(setup, Eigen::Vector3d(0.0, 0.0, 12e-6));
  EXPECT_NEAR(SquarenessOfSweeps(x, y, setup.target).value, -kA - kC, kRounding);
}

std::string RefusalOf(const SweepResult& one, const SweepResult& other,
                      const TargetSettings& target) {
  try {
    SquarenessOfSweeps(one, other, target);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SquarenessOfSweeps, IsRefusedWhenAConditionFails) {
  const SweepSetup setup = TestSetup();
  const Eigen::Vector3d level = Eigen::Vector3d::Zero();
  const SweepResult x = SweepOfX(setup, level), y = SweepOfY(setup, level);
  EXPECT_EQ(RefusalOf(x, y, setup.target), "accepted");
  EXPECT_THAT(RefusalOf(x, x, setup.target), testing::HasSubstr("both sweep the X axis"));
  const SweepResult bare = Lean(setup, 'Y', 1e-5, 1e-5, level, "");
  EXPECT_THAT(RefusalOf(x, bare, setup.target), testing::HasSubstr("does not state `mounting`"));
  const SweepResult moved = Lean(setup, 'Y', 1e-5, 1e-5, level, "[mounting]\nid = \"A18\"\n");
  EXPECT_THAT(RefusalOf(x, moved, setup.target), testing::HasSubstr("mounted anew"));
  TargetSettings target = setup.target;
  target.u_squareness = 0.0;
  EXPECT_THAT(RefusalOf(x, y, target), testing::HasSubstr("target.u_squareness_urad"));
  SweepResult foreign = y;
  foreign.machine = "other";
  EXPECT_THAT(RefusalOf(x, foreign, setup.target), testing::HasSubstr("two machines"));
}

}  // namespace squareness_of_sweeps_test
}  // namespace abbe::probes
