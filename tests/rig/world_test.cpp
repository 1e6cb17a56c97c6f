#include "rig/world.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace world_test {

constexpr double kNanometre = 1e-9;

// What a first-order formula leaves out of a reading here: products of two angles of the test's
// population (some 60 urad at most) times the longest arm, 0.1 m, and of an angle and a gap's
// change.
constexpr double kSecondOrder = 4.0 * 60e-6 * 60e-6 * 0.1;

// The first-order change of a gap's complement (positive: the face comes nearer) when the target
// moves by d with errors in the head's frame: [along, side, normal, roll, pitch, yaw].
double ByTarget(const ProbePlace& probe, double d, const Motions& e) {
  const double x = probe.along;
  return probe.top ? e[2] + probe.across * e[3] + (d - x) * e[4]
                   : e[1] - probe.across * e[3] - (d - x) * e[5];
}

// The same when the head moves: it carries its probes' places along.
double ByHead(const ProbePlace& probe, const Motions& e) {
  const double x = probe.along;
  return probe.top ? -(e[2] + probe.across * e[3] - x * e[4])
                   : -(e[1] - probe.across * e[3] + x * e[5]);
}

// Errors of an axis, in the machine, at the head's origin (arm p from the reference point), turned
// into the head's frame by hand: X (x, y, z), Y (y, -x, z), Z (z, y, -x).
Motions InHead(int axis, const Motions& e, const Eigen::Vector3d& p) {
  const double tx = e[0] + e[4] * p.z() - e[5] * p.y();
  const double ty = e[1] + e[5] * p.x() - e[3] * p.z();
  const double tz = e[2] + e[3] * p.y() - e[4] * p.x();
  Motions head;
  if (axis == 0) head << tx, ty, tz, e[3], e[4], e[5];
  if (axis == 1) head << ty, -tx, tz, e[4], -e[3], e[5];
  if (axis == 2) head << tz, ty, -tx, e[5], e[4], -e[3];
  return head;
}

class Sweep : public testing::TestWithParam<int> {};

// models: the five-probe head, target on the swept axis (X, Y) and head on it (Z), with Abbe arms.
TEST_P(Sweep, ReadingsFollowTheFirstOrderFormulas) {
  const int axis = GetParam();
  RigSettings settings = PerfectRig();
  settings.population = DemoRig().population;
  settings.population.squareness = 0.0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const World world(settings, seed);
    const Eigen::Vector3d start = settings.StartOf(axis);
    const Readings at_start = world.ReadingsAt(axis, start);
    double largest = 0.0;
    for (const double d : {0.011, 0.03, 0.0595}) {
      Eigen::Vector3d command = start;
      command[axis] += d;
      const Readings readings = world.ReadingsAt(axis, command);
      const Motions errors =
          InHead(axis, world.ErrorsOf(axis, command[axis]), settings.head[axis].position);
      for (int probe = 0; probe < kProbes; ++probe) {
        const ProbePlace& place = settings.probes[probe];
        const double expected = axis == 2 ? ByHead(place, errors) : ByTarget(place, d, errors);
        EXPECT_NEAR(at_start[probe] - readings[probe], expected, kSecondOrder)
            << "probe " << probe << " at " << d << " seed " << seed;
        largest = std::max(largest, std::abs(expected));
      }
    }
    EXPECT_GT(largest, 500.0 * kSecondOrder);  // a wrong sign would be seen
  }
}

INSTANTIATE_TEST_SUITE_P(AllAxes, Sweep, testing::Values(0, 1, 2));

TEST(World, StartsInTheMiddleOfTheRange) {
  const World world(PerfectRig(), 1);
  for (int axis = 0; axis < kAxes; ++axis) {
    for (const double gap : world.ReadingsAt(axis, world.settings().StartOf(axis))) {
      EXPECT_NEAR(gap, 100e-6, 1e-15);
    }
  }
}

// C0Y turns the Y line about z: the target drifts to -x, and the Y head's side looks along -x, so
// the face comes nearer. B0Z takes the head to +x, where the face is; A0Z takes it to -y, where it
// is too.
TEST(World, SquarenessTurnsTheLines) {
  RigSettings settings = PerfectRig();
  settings.population.squareness = 30e-6;
  const World world(settings, 4);
  const auto change = [&](int axis, int probe) {
    Eigen::Vector3d command = settings.StartOf(axis);
    const double before = world.ReadingsAt(axis, command)[probe];
    command[axis] += 0.05;
    return before - world.ReadingsAt(axis, command)[probe];
  };
  const auto& [a0z, b0z, c0y] = world.squareness();
  EXPECT_NEAR(change(0, 0), 0.0, 0.01 * kNanometre);
  EXPECT_NEAR(change(1, 3), 0.05 * c0y, 0.01 * kNanometre);
  EXPECT_NEAR(change(2, 0), 0.05 * b0z, 0.01 * kNanometre);
  EXPECT_NEAR(change(2, 3), 0.05 * a0z, 0.01 * kNanometre);
}

// The tilt of the target is a slope: positive about y lowers what lies ahead, and moving the target
// by d brings what lay d behind under the probe.
TEST(World, TiltOfTheTargetIsASlope) {
  RigSettings settings = PerfectRig();
  settings.target_tilt = 100e-6;
  const World world(settings, 5);
  const Readings before = world.ReadingsAt(0, {0.0, 0.0, 0.0});
  const Readings after = world.ReadingsAt(0, {0.05, 0.0, 0.0});
  const Eigen::Vector3d tilt = world.target().tilt;
  EXPECT_NEAR(before[0] - after[0], 0.05 * tilt.y(), kSecondOrder);
  EXPECT_NEAR(before[3] - after[3], -0.05 * tilt.z(), kSecondOrder);
  EXPECT_GT(std::abs(tilt.y()), 1e-6);
}

// Squareness of the target's faces, in the sense of C0Y, B0Z, A0Z: the later sweep's face turns.
TEST(World, SquarenessOfTheTargetLooksLikeThatOfTheMachine) {
  RigSettings settings = PerfectRig();
  settings.target_squareness = 40e-6;
  const World world(settings, 5);
  const auto slope = [&](int axis, int probe) {
    Eigen::Vector3d command = settings.StartOf(axis);
    const double before = world.ReadingsAt(axis, command)[probe];
    command[axis] += 0.05;
    return (before - world.ReadingsAt(axis, command)[probe]) / 0.05;
  };
  EXPECT_NEAR(slope(0, 0), 0.0, 1e-9);
  EXPECT_NEAR(slope(1, 3), -40e-6, 1e-8);  // the Y line would have to lean as much to read 0
  EXPECT_NEAR(slope(2, 0), -40e-6, 1e-8);
  EXPECT_NEAR(slope(2, 3), -40e-6, 1e-8);
}

TEST(World, GainActsAboutTheMiddleOfTheRange) {
  RigSettings settings = PerfectRig();
  settings.population.pitch = 100e-6;
  const World plain(settings, 6);
  settings.gain = 0.05;
  const World world(settings, 6);
  const Eigen::Vector3d command(0.04, 0.0, 0.0);
  const Readings gaps = world.TrueGaps(0, command), readings = world.ReadingsAt(0, command);
  EXPECT_NEAR(world.ReadingsAt(0, {0.0, 0.0, 0.0})[0], 100e-6, 1e-15);
  for (int probe = 0; probe < 3; ++probe) {
    EXPECT_NEAR(gaps[probe], plain.TrueGaps(0, command)[probe], 1e-15);
    EXPECT_NEAR((readings[probe] - 100e-6) / (gaps[probe] - 100e-6),
                1.0 + world.probes()[probe].gain, 1e-9);
  }
}

// models: a circular electrode of radius a at gap g over a tilt phi shows g (1 + sqrt(1 - (a phi /
// g)^2)) / 2 to second order g - a^2 phi^2 / (4 g): 1 mm and 500 urad at 100 um make 0.625 nm.
TEST(World, TiltLowersTheGapOfAWideElectrode) {
  EXPECT_NEAR(TiltResponse(100e-6, 500e-6, 1e-3) - 100e-6, -0.625 * kNanometre, 1e-3 * kNanometre);
  RigSettings settings = PerfectRig();
  settings.installation_angle = 500e-6;
  settings.electrode = 1e-3;
  const World world(settings, 2);
  const Eigen::Vector3d start = settings.StartOf(0);
  const double lowered = world.ReadingsAt(0, start)[0] - world.TrueGaps(0, start)[0];
  EXPECT_LT(lowered, -0.01 * kNanometre);
}

// The same faces serve the sweeps of X and Y: their form is one function of the place on the face.
TEST(World, FormBelongsToTheFace) {
  RigSettings settings = PerfectRig();
  settings.form = 1e-6;
  const World world(settings, 8);
  const auto seen = [&](int axis, int probe, double d) {
    Eigen::Vector3d command = settings.StartOf(axis);
    command[axis] += d;
    return world.TrueGaps(axis, command)[probe];
  };
  // Probe a at d = 10 mm sees the corner, in both sweeps. At d = -10 mm the X head's b (0, 10 mm)
  // and the Y head's c (0, -10 mm), whose side points to -x, both see the place (10, 10) mm.
  const double in_x = seen(0, 1, -0.01) - seen(0, 0, 0.01);
  const double in_y = seen(1, 2, -0.01) - seen(1, 0, 0.01);
  // The gap setting moves the head by the form of the side face, some 2 um, along the top face.
  EXPECT_NEAR(in_x, in_y, 2.0 * 1e-6 * 1e-6 / settings.form_length);
  EXPECT_GT(std::abs(in_x), 100 * kNanometre);
}

// Volumetric error of [w X Y b Z t] at a tool offset p: the three linear equations of Lin and
// Shen's column machine, with the X line as the primary.
TEST(World, ComposesTheChainOfAColumnMachine) {
  RigSettings settings = PerfectRig();
  settings.population = DemoRig().population;
  const World world(settings, 12);
  const Eigen::Vector3d command(0.05, 0.02, 0.04), p(0.03, -0.02, -0.05);
  const Motions x = world.ErrorsOf(0, command.x()), y = world.ErrorsOf(1, command.y()),
                z = world.ErrorsOf(2, command.z());
  const auto& [a0z, b0z, c0y] = world.squareness();
  const Displacement target = world.PoseOfTarget(command), head = world.PoseOfHead(command);
  const Eigen::Vector3d found = target.rotation.transpose() * (head * p - target.translation);
  const Eigen::Vector3d nominal = p + Eigen::Vector3d(-command.x(), -command.y(), command.z());
  const auto [X, Y, Z] = std::tuple(command.x(), command.y(), command.z());
  const double ea = x[3] + y[3], eb = x[4] + y[4], ec = x[5] + y[5];
  const Eigen::Vector3d expected(
      -x[0] - y[0] + z[0] + b0z * Z + c0y * Y - Z * eb - Y * ec + p.y() * (ec - z[5]) -
          p.z() * (eb - z[4]),
      -x[1] - y[1] + z[1] - a0z * Z + Z * ea + X * x[5] - p.x() * (ec - z[5]) + p.z() * (ea - z[3]),
      -x[2] - y[2] + z[2] - X * x[4] + Y * ea + p.x() * (eb - z[4]) - p.y() * (ea - z[3]));
  EXPECT_LT((found - nominal - expected).norm(), kSecondOrder);
  EXPECT_GT(expected.norm(), 500.0 * kSecondOrder);
}

// The same machine, counted the other way, stands where it stood; what its probes see begins at the
// other end, but the carriages go the same ways.
TEST(World, IsTheSameMachineWhicheverWayItCounts) {
  const RigSettings by_carriage = DemoRig();
  RigSettings as_tool = by_carriage;
  for (const int axis : {0, 1}) {
    as_tool.sense[axis] = -1.0;
    as_tool.travels[axis] = {-by_carriage.travels[axis].last, -by_carriage.travels[axis].first};
  }
  const World one(by_carriage, 3), other(as_tool, 3);
  const Eigen::Vector3d place(0.05, 0.02, 0.04), number(-0.05, -0.02, 0.04);
  const Displacement target = one.PoseOfTarget(place), same = other.PoseOfTarget(number);
  EXPECT_EQ((target.rotation - same.rotation).norm(), 0.0);
  EXPECT_EQ((target.translation - same.translation).norm(), 0.0);
  EXPECT_GT((target.translation - Eigen::Vector3d(0.05, 0.02, 0.0)).norm(), 1e-7);
  // EXX along the count, the others in the machine: a scale that is too long is so either way.
  EXPECT_EQ(other.ErrorsOf(0, -0.05)[0], -one.ErrorsOf(0, 0.05)[0]);
  EXPECT_EQ(other.ErrorsOf(0, -0.05).tail<5>(), one.ErrorsOf(0, 0.05).tail<5>());
}

// A bridge that carries everything: the tool passes Z, X and Y in turn.
TEST(World, ComposesTheChainOfABridge) {
  RigSettings settings = PerfectRig();
  settings.population = DemoRig().population;
  settings.workpiece_axes = "";
  settings.tool_axes = "YXZ";
  const World world(settings, 12);
  const Eigen::Vector3d command(0.05, 0.02, 0.04), p(0.03, -0.02, -0.05);
  const Motions x = world.ErrorsOf(0, command.x()), y = world.ErrorsOf(1, command.y()),
                z = world.ErrorsOf(2, command.z());
  const auto& [a0z, b0z, c0y] = world.squareness();
  const auto carried = [](const Motions& e, const Eigen::Vector3d& arm) -> Eigen::Vector3d {
    return e.head<3>() + e.tail<3>().cross(arm);
  };
  const Eigen::Vector3d on_x = p + Eigen::Vector3d(0, 0, command.z());
  const Eigen::Vector3d on_y = on_x + Eigen::Vector3d(command.x(), 0, 0);
  const Eigen::Vector3d lean(b0z * command.z() - c0y * command.y(), -a0z * command.z(), 0.0);
  const Eigen::Vector3d expected = carried(z, p) + carried(x, on_x) + carried(y, on_y) + lean;
  EXPECT_LT((world.PoseOfHead(command) * p - p - command - expected).norm(), kSecondOrder);
  EXPECT_EQ(world.PoseOfTarget(command).translation.norm(), 0.0);
}

// With everything drawn from the default population no probe leaves its range, 0 to 200 um.
TEST(World, GapsStayInRange) {
  const RigSettings settings = DemoRig();
  double least = 1.0, most = 0.0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const World world(settings, seed);
    for (int axis = 0; axis < kAxes; ++axis) {
      for (double d = -0.5e-3; d < 61e-3; d += 6e-3) {
        Eigen::Vector3d command = settings.StartOf(axis);
        command[axis] += d;
        for (const double gap : world.ReadingsAt(axis, command)) {
          least = std::min(least, gap);
          most = std::max(most, gap);
        }
      }
    }
  }
  EXPECT_GT(least, 20e-6);
  EXPECT_LT(most, 180e-6);
  RecordProperty("least_um", std::to_string(least * 1e6));
  RecordProperty("most_um", std::to_string(most * 1e6));
}

TEST(RigSettings, RefusesWhatItCannotServe) {
  const auto read = [](const std::string& text) {
    return ReadRigSettings(settings::Document::Parse(text, "m.toml").Root());
  };
  const std::string travels =
      "[axis]\nX={travel_mm=[0,60],positive=\"carriage\"}\n"
      "Y={travel_mm=[0,60],positive=\"carriage\"}\nZ.travel_mm=[0,60]\n";
  const std::string head = "name=\"m\"\nchain=\"[w X Y b Z t]\"\n";
  EXPECT_NO_THROW(read(head + travels));
  EXPECT_THROW(read("name=\"m\"\nchain=\"[w X X b Z t]\"\n" + travels), InputError);
  EXPECT_THROW(read("name=\"m\"\nchain=\"[w X Y Z t]\"\n" + travels), InputError);
  EXPECT_THROW(read(head + travels + "[rig]\nlag=3\n"), InputError);
  EXPECT_THROW(read(head + "[axis]\nX.travel_mm=[0,60]\nY.travel_mm=[0,60]\nZ.travel_mm=[0,60]\n"),
               InputError);
  EXPECT_THROW(read(head + travels + "[head.axis_Y]\nrotation=[\"y\",\"x\",\"z\"]\n"), InputError);
}

TEST(RigSettings, ReadsAnyChainOfThreeAxes) {
  const auto read = [](const std::string& chain) {
    return ReadRigSettings(
        settings::Document::Parse("name=\"m\"\nchain=\"" + chain +
                                      "\"\n[axis]\n"
                                      "X={travel_mm=[0,60],positive=\"carriage\"}\n"
                                      "Y={travel_mm=[0,60],positive=\"tool\"}\n"
                                      "Z={travel_mm=[0,60],positive=\"tool\"}\n",
                                  "m.toml")
            .Root());
  };
  EXPECT_EQ(read("[w X' Y' b Z (C) t]").workpiece_axes, "XY");
  EXPECT_EQ(read("[w X' Y' b Z (C) t]").tool_axes, "Z");
  EXPECT_EQ(read("[w b Y X Z t]").workpiece_axes, "");
  EXPECT_TRUE(read("[w Y b X Z t]").CarriesTarget(1));
  EXPECT_FALSE(read("[w Y b X Z t]").CarriesTarget(0));
  EXPECT_EQ(read("moving-horizontal-arm").tool_axes, "XZY");
  EXPECT_THROW(read("moving-arm"), InputError);
  EXPECT_EQ(read("column").sense, (std::array{1.0, -1.0, 1.0}));
  EXPECT_EQ(read("moving-bridge").sense, (std::array{1.0, 1.0, 1.0}));
}

}  // namespace world_test
}  // namespace abbe::rig
