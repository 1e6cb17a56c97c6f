// Outliers where a motion begins or ends, which their neighbours do not show.
#include "diagnosis/stray_readings.h"

#include <gtest/gtest.h>

#include "diagnosis/hold_out.h"
#include "tests/hidden_effects/judgement.h"

namespace abbe {
namespace stray_readings_test {

// Two of these twelve lie at the ends of motions, and ten structures had been told of them.
TEST(StrayReadings, AreCountedWithTheOutliersOfTheirChannel) {
  const auto worlds = HiddenWorlds(rig::CampaignKind::kStandard).WithTrailing(1e-6);
  const std::uint64_t seed = 3;
  const Diagnosis diagnosis =
      DiagnosisOf(worlds, seed, worlds.Record(seed, {"outliers:object=pivot_1:count=12"}));
  EXPECT_EQ(diagnosis.verdict, diagnosis::Verdict::kExplained);
  ASSERT_EQ(diagnosis.findings.size(), 2U);  // the ball trails too
  const Finding& outliers = diagnosis.findings.back();
  EXPECT_EQ(outliers.score.candidate.Name(), "outliers:pivot_1");
  EXPECT_EQ(outliers.score.coefficients[0], 12.0);
}

// What is held out is simulated anew from the recordings.
TEST(StrayReadings, StayOutOfWhatIsHeldOut) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const auto world = worlds.Record(3, {"outliers:object=pivot_1:count=12"});
  const diagnosis::Campaign campaign = worlds.Recordings(world);
  const auto strays = diagnosis::StrayReadingsOf(diagnosis::Fit(campaign));
  ASSERT_FALSE(strays.empty());
  const auto held_out = [&](const diagnosis::Campaign& of) {
    return diagnosis::HoldOut(of, world.recordings, {}).before;
  };
  EXPECT_LT(held_out(campaign.Without(strays)), held_out(campaign) - 0.005);  // few of many rows
}

TEST(StrayReadings, AreNoneWhereAnAxisJumpsAsItTurns) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const auto world = worlds.Record(3, {"reversal-spike:object=X:height_um=3:decay_mm=0.02"});
  const diagnosis::Campaign campaign = worlds.Recordings(world);
  const diagnosis::Fit fit(campaign);
  ASSERT_GT(fit.chi_square() / static_cast<double>(fit.rows()), 1.1);
  EXPECT_TRUE(diagnosis::StrayReadingsOf(fit).empty());
}

}  // namespace stray_readings_test
}  // namespace abbe
