// The seat of the target on its screws: exact geometry, large turns.
#include "rig/target_screws.h"

#include <gtest/gtest.h>

#include "tests/rig/demo_rig.h"

namespace abbe::rig {
namespace target_screws_test {

// Each support touches the plane of the target there: the tip of its screw lies in the plane that the
// target had at the support, moved with it.
TEST(TargetScrews, EveryTipTouchesItsFace) {
  const RigSettings settings = DemoRig();
  const Eigen::Vector3d corner(0.02, 0.015, 0.04);
  TargetScrews screws(settings, corner);
  double turns = 8.0;  // 2 mm
  std::vector<double> moved;
  for (const TargetScrew& screw : settings.screws) {
    screws.Turn(screw.name, turns);
    moved.push_back(turns * screw.pitch);
    turns = -0.7 * turns;
  }
  for (std::size_t i = 0; i < settings.screws.size(); ++i) {
    const TargetScrew& screw = settings.screws[i];
    const Eigen::Vector3d support = corner + screw.place;
    const Eigen::Vector3d tip = support + moved[i] * screw.direction;
    const Eigen::Vector3d normal = screws.Seat().rotation * screw.direction;
    EXPECT_NEAR(normal.dot(tip - screws.Seat() * support), 0.0, 1e-12) << screw.name;
  }
  EXPECT_NEAR(
      (screws.Seat().rotation.transpose() * screws.Seat().rotation - Eigen::Matrix3d::Identity())
          .norm(),
      0.0, 1e-14);
}

TEST(TargetScrews, TurnedBackItSitsAsMounted) {
  const RigSettings settings = DemoRig();
  TargetScrews screws(settings, Eigen::Vector3d::Zero());
  screws.Turn("base_back", 1.5);
  screws.Turn("base_back", -1.5);
  EXPECT_NEAR(screws.Seat().translation.norm(), 0.0, 1e-15);
  EXPECT_THROW(screws.Turn("no such", 1.0), InputError);
}

}  // namespace target_screws_test
}  // namespace abbe::rig
