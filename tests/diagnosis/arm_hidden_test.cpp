// Does the diagnosis find what is hidden in an arm before a tracker, and nothing where nothing is?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "tests/diagnosis/arm_world.h"
#include "tests/seeds.h"

namespace abbe {
namespace arm_hidden_test {

using diagnosis::Diagnosis;
using diagnosis::Verdict;

Diagnosis DiagnosisOf(const recording::Recording& recording) {
  diagnosis::Campaign campaign(ArmWorld::SetupOf());
  campaign.Add(recording);
  Diagnosis diagnosis = diagnosis::Diagnose(campaign);
  fmt::print("{}: {}, chi-square per row {:.3f} to {:.3f}", recording.name, Name(diagnosis.verdict),
             diagnosis.chi_before, diagnosis.chi_after);
  for (const auto& finding : diagnosis.findings) {
    fmt::print(", {} {:.4f}", finding.score.candidate.Name(), finding.probability);
  }
  for (const auto& left : diagnosis.leftovers) fmt::print(", {} by {}", left.object, left.variable);
  fmt::print("\n");
  return diagnosis;
}

TEST(ArmsHidden, ShowNothingWhereNothingIsHidden) {
  const Seeds seeds = SeedsFromEnvironment();
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    EXPECT_EQ(DiagnosisOf(ArmWorld::Record(seed)).verdict, Verdict::kClean) << seed;
  }
}

struct Shown {
  const char* name;
  HiddenInArm hidden;
  std::vector<double> keys;  // SI
};
void PrintTo(const Shown& shown, std::ostream* out) { *out << shown.name; }

class ShownInAnArm : public testing::TestWithParam<Shown> {};

TEST_P(ShownInAnArm, IsNamedAloneWithItsSize) {
  const Shown& shown = GetParam();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Diagnosis diagnosis = DiagnosisOf(ArmWorld::Record(seed, shown.hidden));
    EXPECT_EQ(diagnosis.verdict, Verdict::kExplained) << seed;
    ASSERT_EQ(diagnosis.findings.size(), 1U) << seed;
    const diagnosis::Score& score = diagnosis.findings.front().score;
    EXPECT_EQ(score.candidate.Name(), shown.name);
    const auto [values, u] = KeysOf(score);
    for (std::size_t i = 0; i < shown.keys.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      // 99.99 % of normal errors.
      EXPECT_NEAR(values[at], shown.keys[i], 3.9 * u[at]) << seed << " " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, ShownInAnArm,
    testing::Values(Shown{"encoder-eccentricity:pivot_1",
                          {.joint = 0, .eccentricity_sin = 300e-6, .eccentricity_cos = -200e-6},
                          {300e-6, -200e-6}},
                    Shown{"encoder-eccentricity:pivot_2",
                          {.joint = 1, .eccentricity_sin = 300e-6, .eccentricity_cos = -200e-6},
                          {300e-6, -200e-6}},
                    Shown{"encoder-subdivision:pivot_3",
                          {.joint = 2, .wave = 60e-6, .order = 60.0},
                          {60.0, 60e-6, 0.0}},
                    Shown{"joint-gain:pivot_4", {.joint = 3, .gain = 300e-6}, {300e-6}},
                    Shown{"joint-compliance:pivot_2",
                          {.joint = 1, .own = 300e-6, .wrist = 400e-6, .load = 200e-6},
                          {300e-6, 400e-6, 200e-6}},
                    Shown{"joint-compliance:pivot_3",
                          {.joint = 2, .own = 300e-6, .wrist = 400e-6, .load = 200e-6},
                          {300e-6, 400e-6, 200e-6}},
                    Shown{"joint-compliance:pivot_5", {.joint = 4, .load = 2e-3}, {0.0, 0.0, 2e-3}},
                    Shown{"arm-drift:arm",
                          {.drift_x = 0.1, .drift_z = -0.15, .drift_poses = 40.0},
                          {100e-6, 0.0, -150e-6, 40.0}},
                    Shown{"late-reading:arm", {.behind = 300e-6}, {1.0}},
                    Shown{"encoder-count-slip:pivot_5", {.joint = 4, .slip = 400e-6}, {}}));

// Gears have waves of any order: where one is told for certain, U95 reaches that.
TEST(ArmsHidden, AnOrderThatIsNotWholeIsWithinU95) {
  constexpr double kOrder = 60.4;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Diagnosis diagnosis =
        DiagnosisOf(ArmWorld::Record(seed, {.joint = 2, .wave = 15e-6, .order = kOrder}));
    for (const auto& finding : diagnosis.findings) {
      EXPECT_EQ(finding.score.candidate.Name(), "encoder-subdivision:pivot_3");
      const auto [values, u] = KeysOf(finding.score);
      EXPECT_NEAR(values[0], kOrder, 2.0 * u[0]) << seed;
    }
  }
}

// Outliers are counted by their rows, and no cause is blamed for them.
TEST(ArmsHidden, PosesFarOffAreLeftOut) {
  const Diagnosis diagnosis = DiagnosisOf(ArmWorld::Record(3, {.far_off = 4}));
  ASSERT_EQ(diagnosis.findings.size(), 1U);
  EXPECT_EQ(diagnosis.findings.front().score.candidate.Name(), "outliers:arm");
  EXPECT_EQ(diagnosis.findings.front().score.coefficients[0], 4.0);
  EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
}

}  // namespace arm_hidden_test
}  // namespace abbe
