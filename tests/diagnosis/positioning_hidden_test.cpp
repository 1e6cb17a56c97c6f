// Does the diagnosis find in a positioning test what the rig hides, and nothing where nothing is?
// Worlds: ABBE_SEEDS, ABBE_SHARD.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/diagnosis/positioning_world.h"
#include "tests/hidden_effects/judgement.h"
#include "tests/seeds.h"

namespace abbe {
namespace positioning_hidden_test {

Diagnosis DiagnosisOf(const PositioningWorlds& worlds, std::uint64_t seed,
                      const rig::Campaign& world) {
  diagnosis::Campaign campaign(worlds.setup());
  for (const auto& recording : world.recordings) campaign.Add(recording);
  const Diagnosis diagnosis = diagnosis::Diagnose(campaign);
  Print(seed, world, diagnosis);
  return diagnosis;
}

TEST(PositioningTests, ShowNothingWhereNothingIsHidden) {
  const PositioningWorlds worlds;
  const Seeds seeds = SeedsFromEnvironment();
  Rate alarms;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const PositioningPlan plan{.axis = static_cast<int>(seed % 3)};
    const Diagnosis diagnosis = DiagnosisOf(worlds, seed, worlds.Record(seed, {}, plan));
    alarms.Add(diagnosis.verdict != Verdict::kClean);
  }
  EXPECT_LE(alarms.Low(), 0.01) << alarms.Text();
}

// Any size that the rig draws, seen or not: it may stay hidden, or be said to be unexplained.
TEST(PositioningTests, AreNotExplainedByAWrongCause) {
  const std::vector<std::string> causes{"backlash",       "leadscrew-cyclic", "scale-error",
                                        "thermal-growth", "warm-up-drift",    "reversal-spike",
                                        "servo-lag",      "vibration"};
  const PositioningWorlds worlds;
  const Seeds seeds = SeedsFromEnvironment();
  Rate wrong, inside;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const PositioningPlan plan{.axis = static_cast<int>(seed % 3)};
    const std::string hidden =
        fmt::format("{}:object={}", causes[seed % causes.size()], "XYZ"[plan.axis]);
    const auto world = worlds.Record(seed, {hidden}, plan);
    const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
    wrong.Add(diagnosis.verdict == Verdict::kExplained &&
              !Names(diagnosis.findings.front(), world.hidden.front()));
    if (!diagnosis.findings.empty() && Names(diagnosis.findings.front(), world.hidden.front())) {
      AddSizes(diagnosis.findings.front(), world.hidden.front(), inside);
    }
  }
  fmt::print("keys of those named first inside U95: {}\n", inside.Text());
  EXPECT_GE(inside.High(), 0.9) << inside.Text();
  EXPECT_LE(wrong.Low(), 0.01) << wrong.Text();
}

struct Shown {
  const char* hidden;
  std::vector<std::pair<std::string, double>> keys;
  PositioningPlan plan = {};
};

class ShownInPositioning : public testing::TestWithParam<Shown> {};

TEST_P(ShownInPositioning, IsNamedFirstWithItsSize) {
  const PositioningWorlds worlds;
  const Shown& shown = GetParam();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto world = worlds.Record(seed, {shown.hidden}, shown.plan);
    const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
    EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
    ASSERT_EQ(diagnosis.findings.size(), 1U);
    const Finding& first = diagnosis.findings.front();
    EXPECT_TRUE(Names(first, world.hidden.front())) << first.score.candidate.Name();
    const auto keys = KeysOf(first.score);
    for (const auto& [name, truth] : shown.keys) {
      for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
        const auto& key = first.score.candidate.cause->keys[static_cast<std::size_t>(i)];
        if (key.name != name) continue;
        // 99.99 % of normal errors.
        EXPECT_NEAR(keys.values[i] / key.unit, truth, 3.9 * keys.u[i] / key.unit) << name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    OnTheRig, ShownInPositioning,
    testing::Values(Shown{"backlash:object=X:width_um=3", {{"width_um", 3.0}}},
                    Shown{"backlash:object=Z:width_um=1", {{"width_um", 1.0}}, {.axis = 2}},
                    Shown{"leadscrew-cyclic:object=Y:pitch_mm=6:amplitude_um=2:phase_rad=1",
                          {{"pitch_mm", 6.0}, {"amplitude_um", 2.0}, {"phase_rad", 1.0}},
                          {.axis = 1, .targets = 40, .cycles = 3}},
                    Shown{"warm-up-drift:object=X:amplitude_um=4:time_constant_s=100",
                          {{"amplitude_um", 4.0}, {"time_constant_s", 100.0}}}));

// A mean of 6 um, from 2 um at one end to 10 um at the other, or bowed by 5 um.
TEST(PositioningTests, TellHowBacklashVariesAlongTheAxis) {
  const PositioningWorlds worlds;
  for (const auto& [change, bow] : {std::pair{8.0, 0.0}, {0.0, -5.0}}) {
    const auto world = worlds.Record(
        5, {"backlash:object=X:width_um=6",
            fmt::format("varying-backlash:object=X:change_um={}:bow_um={}", change, bow)});
    const Diagnosis diagnosis = DiagnosisOf(worlds, 5, world);
    EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
    ASSERT_EQ(diagnosis.findings.size(), 2U);
    for (const Finding& finding : diagnosis.findings) {
      const auto keys = KeysOf(finding.score);
      if (finding.score.candidate.Name() == "backlash:X") {
        EXPECT_NEAR(keys.values[0], 6e-6, 3.9 * keys.u[0]);
        continue;
      }
      EXPECT_EQ(finding.score.candidate.Name(), "varying-backlash:X");
      EXPECT_NEAR(keys.values[0], 1e-6 * change, 3.9 * keys.u[0]);
      EXPECT_NEAR(keys.values[1], 1e-6 * bow, 3.9 * keys.u[1]);
      EXPECT_LT(keys.u[0], 0.5e-6);
      EXPECT_EQ(keys.values[2], 0.0);
      EXPECT_NEAR(keys.values[3], 60e-3, 1e-12);
    }
  }
}

}  // namespace positioning_hidden_test
}  // namespace abbe
