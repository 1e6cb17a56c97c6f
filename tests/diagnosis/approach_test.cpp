// Lengths and plates whose places were approached from both sides, on a machine with backlash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../folders.h"
#include "diagnosis/diagnose.h"
#include "rig/campaign_machine.h"
#include "rig/record_lengths.h"
#include "rig/record_plate.h"
#include "settings/document.h"

namespace abbe::diagnosis {
namespace approach_test {

constexpr double kWidth = 3e-6;  // m

const settings::Document& Demo() {
  static const settings::Document document = settings::Document::Read(DemoMillFile());
  return document;
}

rig::HiddenEffects Backlash(const std::string& axis, std::uint64_t seed) {
  return {rig::ParseHidden("backlash:object=" + axis + ":width_um=3", seed, {})};
}

recording::Recording LengthsOf(std::uint64_t seed) {
  const auto machine = rig::ReadCampaignMachine(Demo().Root());
  const rig::HiddenEffects hidden = Backlash("X", seed);
  const rig::LinkageRig rig(rig::World(machine.rig, seed, hidden),
                            rig::Linkage(*machine.linkage, seed, hidden));
  return rig::RecordLengths(rig, {.at = Eigen::Vector3d::Constant(30e-3), .both_ways = true});
}

recording::Recording PlateOf(std::uint64_t seed) {
  const rig::World world(rig::ReadRigSettings(Demo().Root()), seed, Backlash("Y", seed));
  return rig::RecordPlate(world, {.both_sides = true});
}

recording::Recording WithoutApproach(recording::Recording recording) {
  std::erase_if(recording.columns,
                [](const auto& column) { return column.name.starts_with("approach_"); });
  return recording;
}

Campaign CampaignOf(const recording::Recording& recording) {
  Campaign campaign({machine::ReadMachine(Demo().Root()), std::nullopt, {}, {}, std::nullopt});
  campaign.Add(recording);
  return campaign;
}

void ExpectFound(const recording::Recording& recording, const std::string& name) {
  const Campaign campaign = CampaignOf(recording);
  EXPECT_THAT(campaign.notes(), testing::Not(testing::Contains(testing::HasSubstr("approach_x"))));
  const Diagnosis diagnosis = Diagnose(campaign);
  ASSERT_EQ(diagnosis.findings.size(), 1u);
  // One line through the volume: play of an angle, which is in no catalogue, would do the same.
  EXPECT_GT(diagnosis.findings[0].probability, 0.95);
  EXPECT_TRUE(diagnosis.leftovers.empty());
  EXPECT_EQ(diagnosis.findings[0].score.candidate.Name(), name);
  const Keys keys = KeysOf(diagnosis.findings[0].score);
  EXPECT_NEAR(keys.values[0], kWidth, 3.9 * keys.u[0]);
  EXPECT_LT(keys.u[0], 0.1 * kWidth);
}

TEST(Approach, ShowsBacklashInLengthsThereAndBack) { ExpectFound(LengthsOf(51), "backlash:X"); }

TEST(Approach, ShowsBacklashInAPlate) { ExpectFound(PlateOf(52), "backlash:Y"); }

TEST(Approach, ThatIsNotStatedIsNoted) {
  for (const auto& recording : {WithoutApproach(LengthsOf(51)), WithoutApproach(PlateOf(52))}) {
    const Campaign campaign = CampaignOf(recording);
    const Diagnosis diagnosis = Diagnose(campaign);
    EXPECT_FALSE(std::ranges::any_of(diagnosis.findings, [](const Finding& finding) {
      return finding.score.candidate.cause->id == "backlash";
    }));
    EXPECT_NE(diagnosis.verdict, Verdict::kExplained);
    EXPECT_THAT(campaign.notes(), testing::Contains(testing::HasSubstr("approach_x")));
  }
}

}  // namespace approach_test
}  // namespace abbe::diagnosis
