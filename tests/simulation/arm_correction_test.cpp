// A recording of an arm with something hidden, corrected by a model that a person wrote, against the
// same seed's recording without it. The nominal arm is some mrad off the real one, so a hundredth of
// the effect may be left.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "simulation/causes/registry.h"
#include "simulation/correction.h"
#include "simulation/kinds.h"
#include "tests/diagnosis/arm_world.h"

namespace abbe::simulation {
namespace arm_correction_test {

using Eigen::VectorXd;

struct Hidden {
  const char* name;
  HiddenInArm in_arm;
  const char* cause;
  const char* object;
  VectorXd values;
  bool of_angles;  // else of places
};
void PrintTo(const Hidden& hidden, std::ostream* out) { *out << hidden.name; }

std::vector<Hidden> AllHidden() {
  return {{"gain",
           {.joint = 1, .gain = 500e-6},
           "joint-gain",
           "pivot_2",
           VectorXd::Constant(1, 500e-6),
           true},
          {"weights",
           {.joint = 1, .own = 500e-6, .wrist = 900e-6, .load = -700e-6},
           "joint-compliance",
           "pivot_2",
           Eigen::Vector4d(500e-6, 900e-6, -700e-6, 0.0),
           false},
          {"drift",
           {.drift_x = 0.3, .drift_z = -0.2, .drift_poses = 40.0},
           "arm-drift",
           "arm",
           Eigen::Vector4d(0.3e-3, 0.0, -0.2e-3, 40.0),
           false}};
}

class ArmCorrection : public testing::TestWithParam<Hidden> {};

// The largest difference of the named columns, in their unit.
double Apart(const recording::Recording& a, const recording::Recording& b, const char* prefix) {
  double largest = 0.0;
  for (std::size_t c = 0; c < a.columns.size(); ++c) {
    if (!a.columns[c].name.starts_with(prefix)) continue;
    for (std::size_t row = 0; row < a.rows(); ++row) {
      largest = std::max(largest, std::abs(a.columns[c].values[row] - b.columns[c].values[row]));
    }
  }
  return largest;
}

TEST_P(ArmCorrection, LeavesTheRecordingOfTheArmWithoutTheCause) {
  const Hidden& hidden = GetParam();
  constexpr double kLeft = 0.01;
  const Instruments on = ArmWorld::SetupOf();
  const auto clean = ArmWorld::Record(5), recorded = ArmWorld::Record(5, hidden.in_arm);
  const Correction corrected = Correct(
      recorded, {{&CauseNamed(hidden.cause), hidden.object, hidden.values, {}, {}}}, {}, on);
  for (const char* prefix : {"pivot_", "ref_"}) {
    const double effect = Apart(recorded, clean, prefix);
    EXPECT_EQ(effect > 0.0, hidden.of_angles == (std::string(prefix) == "pivot_")) << prefix;
    EXPECT_LE(Apart(corrected.recording, clean, prefix), kLeft * effect) << prefix;
  }
  EXPECT_EQ(corrected.changes.angles.largest > 0.0, hidden.of_angles);
  EXPECT_EQ(corrected.changes.positions.largest > 0.0, !hidden.of_angles);
}

INSTANTIATE_TEST_SUITE_P(Causes, ArmCorrection, testing::ValuesIn(AllHidden()),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace arm_correction_test
}  // namespace abbe::simulation
