#include "simulation/path_displacement.h"

#include <gtest/gtest.h>

#include "simulation/causes/registry.h"

namespace abbe::simulation {
namespace path_displacement_test {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

ModelledCause Of(const char* id, const char* object, const VectorXd& values) {
  return {&CauseNamed(id), object, values, {}, {}};
}

// X to 5 mm and back, 1 mm a point; Y and Z stand.
Matrix3Xd ToAndFro() {
  Matrix3Xd path = Matrix3Xd::Constant(3, 11, 20e-3);
  for (int i = 0; i < 11; ++i) path(0, i) = 1e-3 * (i <= 5 ? i : 10 - i);
  return path;
}

TEST(PathDisplacement, PlayLagsByHalfOnBothWays) {
  const Matrix3Xd beside =
      PathDisplacement(ToAndFro(), 0.0, {Of("backlash", "X", VectorXd::Constant(1, 6e-6))});
  EXPECT_EQ(beside.bottomRows<2>().norm(), 0.0);
  for (int i = 1; i <= 5; ++i) EXPECT_NEAR(beside(0, i), -3e-6, 1e-15) << i;
  for (int i = 6; i <= 10; ++i) EXPECT_NEAR(beside(0, i), 3e-6, 1e-15) << i;
}

TEST(PathDisplacement, LagNeedsAFeed) {
  const std::vector<ModelledCause> lag{Of("servo-lag", "X", VectorXd::Constant(1, 2e-3))};
  EXPECT_EQ(PathDisplacement(ToAndFro(), 0.0, lag).norm(), 0.0);
  const Matrix3Xd beside = PathDisplacement(ToAndFro(), 10e-3, lag);
  EXPECT_NEAR(beside(0, 2), -20e-6, 1e-12);
  EXPECT_NEAR(beside(0, 8), 20e-6, 1e-12);
}

TEST(PathDisplacement, LoadCouplingIsAFunctionOfTwoAxes) {
  const Matrix3Xd path = ToAndFro();
  const Matrix3Xd beside =
      PathDisplacement(path, 0.0, {Of("load-coupling", "XY", VectorXd::Constant(1, 3e-3))});
  for (int i = 0; i < 11; ++i) EXPECT_NEAR(beside(2, i), -3e-3 * path(0, i) * path(1, i), 1e-18);
}

// All known causes on all that they can be of, at a usual size: those of the machine that follow
// its path act, and no other.
TEST(PathDisplacement, OfAllCausesThoseActThatFollowThePath) {
  Matrix3Xd path(3, 21);
  for (int i = 0; i < 21; ++i) {
    const double x = 1e-3 * (i <= 10 ? i : 20 - i);
    path.col(i) << x, 20e-3 + 0.5 * x, 30e-3 - 0.7 * x;
  }
  Trace trace;
  trace.time = trace.clock = VectorXd::LinSpaced(21, 0.0, 20.0);
  trace.pass.assign(21, 1);
  trace.direction.assign(21, 1);
  trace.SetAxes(path);
  trace.head.emplace();
  trace.head->gap = Eigen::MatrixXd::Constant(5, 21, 100e-6);
  trace.linkage.emplace();
  trace.linkage->angles = path.topRows<1>();
  trace.sensors = {"temp_table_c"};
  const Scene scene{{&trace}, Eigen::Vector3d::Constant(0.06)};
  int acting = 0;
  for (const Cause& cause : Causes()) {
    const VectorXd shape = cause.ShapesFor(scene, "X").front();
    const VectorXd values = cause.ValuesOf(cause.plausible, shape);
    for (const Object& object : cause.objects(scene)) {
      const ModelledCause modelled{&cause, object, values, {}, {}};
      const bool acts = cause.CorrectedAt(object) == CorrectedBy::kMotion &&
                        cause.follows == Follows::kPath && !cause.IsRandomField();
      EXPECT_EQ(ActsOnPath(modelled), acts) << modelled.Name();
      const Matrix3Xd beside = PathDisplacement(path, 10e-3, {modelled});
      EXPECT_EQ(beside.norm() > 0.0, acts) << modelled.Name();
      acting += acts;
    }
  }
  EXPECT_EQ(acting,
            18);  // both plays, spike and lag of three axes, mismatch and load of three pairs
}

TEST(PathDisplacement, InstrumentsTheMapAndDriftDoNothing) {
  const Matrix3Xd beside =
      PathDisplacement(ToAndFro(), 10e-3,
                       {Of("scale-error", "X", VectorXd::Constant(1, 1e-4)),
                        Of("probe-gain", "probe_a", VectorXd::Constant(1, 0.1)),
                        Of("warm-up-drift", "X", Eigen::Vector2d(1e-5, 10.0)),
                        Of("vibration", "X", Eigen::Vector3d(7.3, 5e-6, 0.4)),
                        Of("thermal-growth", "X temp_table_c", VectorXd::Constant(1, 1e-5))});
  EXPECT_EQ(beside.norm(), 0.0);
}

}  // namespace path_displacement_test
}  // namespace abbe::simulation
