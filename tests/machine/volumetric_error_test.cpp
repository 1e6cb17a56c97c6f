#include "machine/volumetric_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../folders.h"
#include "failure/failure.h"
#include "machine/configurations.h"
#include "published_volumetric_errors.h"
#include "rig/rig_settings.h"
#include "rig/world.h"
#include "settings/document.h"
#include "volumetric_cases.h"

namespace abbe::machine {
namespace volumetric_error_test {

using Eigen::Vector3d;

// Some hundred products and sums of numbers of size 1, positions and errors alike.
constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

LectureErrors ToLecture(const MotionErrors<double>& errors) {
  LectureErrors e{};
  for (int motion = 0; motion < 3; ++motion) {
    for (int axis = 0; axis < kAxes; ++axis) {
      e.d[motion][axis] = errors.axes[axis][motion];
      e.E[motion][axis] = errors.axes[axis][motion + 3];
    }
  }
  e.alpha = errors.squareness.z();
  e.beta1 = -errors.squareness.y();
  e.beta2 = errors.squareness.x();
  return e;
}

// The lecture takes Y as primary: its X line is turned where ISO turns the Y line. The two differ
// by a turn of the whole workpiece frame about z, which no measurement in the workpiece sees.
TEST(VolumetricError, IsTheLecturesColumnMachineToFirstOrder) {
  const Chain column = ChainOf("column");
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Numbers numbers(seed);
    const auto errors = numbers.Errors(1.0, 1.0);
    const Vector3d q = numbers.Vector(1.0), tool = numbers.Vector(1.0);
    const Vector3d lecture =
        LectureColumn(ToLecture(errors), q.x(), q.y(), q.z(), tool.x(), tool.y(), tool.z());
    const double c0y = errors.squareness.z();
    const Vector3d turn_of_workpiece = Vector3d(0, 0, c0y).cross(Vector3d(-q.x(), -q.y(), 0));
    EXPECT_LT((FirstOrderError(column, q, tool, errors) - lecture - turn_of_workpiece).norm(),
              kRounding);
  }
}

TEST(VolumetricError, IsTheBridgeOfHaAndKhanhToFirstOrderWithTheLackingTermOfEquation19) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Numbers numbers(seed);
    auto errors = numbers.Errors(1.0, 1.0);
    const Vector3d q = numbers.Vector(1.0), tool = numbers.Vector(1.0);
    const auto& [x, y, z] = errors.axes;
    const Vector3d square = errors.squareness;
    const BridgeErrors paper{{-x[0], x[1], x[2]}, {y[0], -y[1], y[2]}, {z[0], z[1], -z[2]},
                             {x[3], x[4], x[5]},  {y[3], y[4], y[5]},  {z[3], z[4], z[5]},
                             square.z(),          -square.y(),         square.x()};
    const Vector3d printed = HaKhanhAsPrinted(paper, q.x(), q.z(), tool.x(), tool.y(), tool.z());
    const Vector3d lacking(paper.zr[1] * tool.z(), 0, 0);
    // xwy turns the X line where ISO turns the Y line: again a turn of the workpiece frame.
    const Vector3d turn_of_workpiece = Vector3d(0, 0, square.z()).cross(Vector3d(q.x(), q.y(), 0));
    const Vector3d exact = FirstOrderError(ChainOf("moving-bridge"), q, tool, errors);
    EXPECT_LT((exact - printed - lacking - turn_of_workpiece).norm(), kRounding);
  }
}

// Without the lacking term a ram that turns about y alone would move a long stylus not at all
// sideways.
TEST(VolumetricError, APitchingRamSwingsTheStylusSidewaysWhichEquation19AsPrintedDenies) {
  MotionErrors<double> errors;
  errors.axes[2][4] = 10e-6;
  const Vector3d error =
      VolumetricError<double>(ChainOf("moving-bridge"), {0.3, 0.4, 0.2}, {0.0, 0.0, -0.1}, errors);
  EXPECT_NEAR(error.x(), -1e-6, 1e-6 * 10e-6);
  BridgeErrors paper{};
  paper.zr[1] = 10e-6;
  EXPECT_EQ(HaKhanhAsPrinted(paper, 0.3, 0.2, 0.0, 0.0, -0.1).x(), 0.0);
}

// The rig multiplies its own poses, with other rotations: the two differ by products of two angles
// (population of 20 urad, 4 sd: 6e-9 at most) times arms of at most 0.3 m.
TEST(VolumetricError, IsWhatTheRigsPosesShow) {
  const auto document = settings::Document::Read(DemoMillFile());
  const Vector3d p_MQ(0.02, 0.03, 0.1), reference(0.01, -0.02, 0.05);
  for (const Chain& chain : AllCounts()) {
    rig::RigSettings settings = rig::ReadRigSettings(document.Root());
    settings.workpiece_axes = chain.workpiece_axes();
    settings.tool_axes = chain.tool_axes();
    for (int axis = 0; axis < kAxes; ++axis) {
      settings.sense[axis] = chain.CarriageSense("XYZ"[axis]);
    }
    settings.reference = reference;
    const rig::World world(settings, 7);
    for (std::uint64_t i = 0; i < 5; ++i) {
      const Vector3d position = 0.03 * (Vector3d::Ones() + Numbers(i).Vector(1.0));
      MotionErrors<double> errors;
      for (int axis = 0; axis < kAxes; ++axis) {
        errors.axes[axis] = world.ErrorsOf(axis, position[axis]);
      }
      const auto& s = world.squareness();
      errors.squareness = {s.a0z, s.b0z, s.c0y};
      const rig::Displacement target = world.PoseOfTarget(position);
      const Vector3d seen =
          target.rotation.transpose() * (world.PoseOfHead(position) * p_MQ - target.translation);
      const Vector3d rig_error = seen - NominalToolInWork<double>(chain, position, p_MQ);
      const Vector3d error = VolumetricError<double>(chain, position, p_MQ - reference, errors);
      EXPECT_LT((error - rig_error).norm(), 2e-9) << chain.Text();
      EXPECT_GT(error.norm(), 1e-7);
    }
  }
}

TEST(Configurations, AreSevenAndEachHasItsChain) {
  EXPECT_EQ(ChainOf("column").Text(), "[w X Y b Z t]");
  EXPECT_EQ(ChainOf("gantry").Text(), "[w b Y X Z t]");
  EXPECT_EQ(ChainOf("l-shaped-bridge").Text(), ChainOf("moving-bridge").Text());
  EXPECT_EQ(ChainOf("fixed-bridge").Text(), "[w Y b X Z t]");
  EXPECT_EQ(ChainOf("moving-horizontal-arm").Text(), "[w b X Z Y t]");
  EXPECT_EQ(ChainOf("fixed-horizontal-arm").Text(), "[w X b Z Y t]");
}

TEST(Configurations, AnUnknownNameIsToldTheNearestAndAll) {
  try {
    ChainOf("gandry");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("\"gandry\" is not a machine configuration"));
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean \"gantry\"?"));
    EXPECT_THAT(error.what(), testing::HasSubstr("column, moving-bridge, gantry"));
  }
}

}  // namespace volumetric_error_test
}  // namespace abbe::machine
