// Does the diagnosis find what is hidden in an arm before a tracker, and nothing where nothing is?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
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
      EXPECT_NEAR(values[at], shown.keys[i], 3.9 * u[at]) << seed;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, ShownInAnArm,
    testing::Values(Shown{"encoder-eccentricity:pivot_1",
                          {.joint = 0, .eccentricity_sin = 300e-6, .eccentricity_cos = -200e-6},
                          {300e-6, -200e-6}},
                    Shown{"joint-gain:pivot_4", {.joint = 3, .gain = 300e-6}, {300e-6}},
                    Shown{"link-gravity-bend:pivot_3", {.joint = 2, .sag = 400e-6}, {}},
                    Shown{"encoder-count-slip:pivot_5", {.joint = 4, .slip = 400e-6}, {}}));

// The first axis stands upright, so the upper arm leans by the angle of its own pivot alone: it
// sags once per turn, as the encoder of that pivot would err if it sat off its axis.
TEST(ArmsHidden, AnUpperArmThatSagsIsNotToldFromItsEncoder) {
  const Diagnosis diagnosis = DiagnosisOf(ArmWorld::Record(1, {.joint = 1, .sag = 400e-6}));
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  ASSERT_EQ(diagnosis.findings.size(), 1U);
  std::set<std::string> names{diagnosis.findings.front().score.candidate.Name()};
  for (const auto& rival : diagnosis.findings.front().rivals) names.insert(rival.candidate.Name());
  EXPECT_TRUE(names.contains("link-gravity-bend:pivot_2"));
  EXPECT_TRUE(names.contains("encoder-eccentricity:pivot_2"));
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
