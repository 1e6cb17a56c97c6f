// What happens late in the standstill of a campaign, and nowhere else: a probe that steps and comes
// back, an encoder that loses counts. The rig holds still for 60 s, 645 rows.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "simulation/trace.h"
#include "tests/hidden_effects/judgement.h"

namespace abbe {
namespace standstill_test {

constexpr double kBlock = 1.0;  // s: more than the readings of one row take

// s since the machine was switched on.
double BeginOfStandstill(const HiddenWorlds& worlds, std::uint64_t seed) {
  const rig::Campaign world = worlds.Record(seed, {});
  const auto& recordings = world.recordings;
  const auto dwell =
      std::ranges::find_if(recordings, [](const auto& each) { return each.Kind() == "dwell"; });
  return simulation::StartedOf(*dwell) - simulation::StartedOf(recordings.front());
}

TEST(Standstill, ShowsAProbeThatStepsAndComesBackLate) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const std::uint64_t seed = 71;
  const double from = BeginOfStandstill(worlds, seed) + 30.0, to = from + 12.0;
  const Diagnosis diagnosis = DiagnosisOf(
      worlds, seed,
      worlds.Record(seed, {fmt::format("unknown-step-and-back:object=probe_c:height_um=0.3:"
                                       "from_s={}:to_s={}",
                                       from, to)}));
  EXPECT_EQ(diagnosis.verdict, Verdict::kUnexplained);
  const auto left = std::ranges::find_if(diagnosis.leftovers, [](const auto& each) {
    return each.object == "probe_c" && each.variable == "time";
  });
  ASSERT_NE(left, diagnosis.leftovers.end());
  ASSERT_GT(left->to, left->from) << "no interval";
  EXPECT_NEAR(left->from, from, kBlock);
  EXPECT_NEAR(left->to, to, kBlock);
  EXPECT_NEAR(std::abs(left->amplitude), 0.3e-6, 0.05e-6);
}

TEST(Standstill, ShowsAnEncoderThatLosesCounts) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const std::uint64_t seed = 72;
  const double instant = BeginOfStandstill(worlds, seed) + 40.0;
  const Diagnosis diagnosis = DiagnosisOf(
      worlds, seed,
      worlds.Record(seed, {fmt::format("encoder-count-slip:object=pivot_2:time_s={}:angle_urad=40",
                                       instant)}));
  ASSERT_EQ(diagnosis.findings.size(), 1u);
  const Finding& finding = diagnosis.findings.front();
  EXPECT_EQ(finding.score.candidate.Name(), "encoder-count-slip:pivot_2");
  const auto keys = KeysOf(finding.score);
  EXPECT_NEAR(keys.values[0], instant, kBlock);
  EXPECT_NEAR(keys.values[1], 40e-6, 3.9 * keys.u[1]);
  // 3 urad in a reading, 80 times 6 readings before it and 40 times after.
  EXPECT_LT(keys.u[1], 1e-6);
}

}  // namespace standstill_test
}  // namespace abbe
