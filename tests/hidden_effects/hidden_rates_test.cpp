// How often the diagnosis is right: the rates, the power and the confusions over many worlds, each
// row by itself (--gtest_filter). Worlds of a row: ABBE_SEEDS, ABBE_SHARD.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/hold_out.h"
#include "tests/hidden_effects/judgement.h"
#include "tests/hidden_effects/rate_table.h"
#include "tests/hidden_effects/visible_effects.h"
#include "tests/seeds.h"

namespace abbe {
namespace hidden_rates_test {

constexpr auto kCampaign = rig::CampaignKind::kStandard;

void ForEachSeed(const std::function<void(std::uint64_t seed)>& use) {
  const Seeds seeds = SeedsFromEnvironment();
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) use(seed);
}

// How often something is said of worlds that hide nothing.
Rate FalseAlarms(const HiddenWorlds& worlds) {
  Rate alarms;
  ForEachSeed([&](std::uint64_t seed) {
    alarms.Add(DiagnosisOf(worlds, seed, worlds.Record(seed, {})).verdict != Verdict::kClean);
  });
  fmt::print("false alarms: {}\n", alarms.Text());
  return alarms;
}

TEST(HiddenRates, OfFalseAlarmsInWhiteNoise) {
  const Rate alarms = FalseAlarms(HiddenWorlds(kCampaign, HiddenWorlds::Noise::kWhite));
  EXPECT_LE(alarms.Low(), 0.01) << alarms.Text();
}

TEST(HiddenRates, OfFalseAlarmsInNoiseThatDrifts) {
  const Rate alarms = FalseAlarms(HiddenWorlds(kCampaign));
  EXPECT_LE(alarms.Low(), 0.02) << alarms.Text();
}

const std::vector<std::pair<std::string, std::string>> kSmoother{
    {"smoothness_mm = 15.0", "smoothness_mm = 40.0"},
    {"straightness_um = 1.0", "straightness_um = 0.4"},
    {"positioning_um = 2.0", "positioning_um = 0.8"},
    {"pitch_urad = 20.0", "pitch_urad = 7.0"}};

TEST(HiddenRates, OfFalseAlarmsOnARougherMachine) {
  const Rate alarms = FalseAlarms(HiddenWorlds(kCampaign).Unlike(kRougher));
  EXPECT_LE(alarms.Low(), 0.02) << alarms.Text();
}

TEST(HiddenRates, OfFalseAlarmsOnASmootherMachine) {
  const Rate alarms = FalseAlarms(HiddenWorlds(kCampaign).Unlike(kSmoother));
  EXPECT_LE(alarms.Low(), 0.02) << alarms.Text();
}

// The same effect with the largest sizes that the rig hides.
std::string Largest(const rig::HiddenEffect& effect) {
  std::string text = fmt::format("{}:object={}", effect.entry->name, effect.object);
  for (const rig::KeyEntry& key : effect.entry->keys) {
    if (key.draw == rig::Draw::kEven || key.draw == rig::Draw::kEvenSigned) {
      text += fmt::format(":{}={}", key.name, key.high);
    }
  }
  return text;
}

bool IsOfData(const rig::HiddenEffect& effect) {
  return effect.entry->name == "stuck-channel" || effect.entry->name == "outliers";
}

// Of the only cause, held out.
Rate AtTheFloor(const HiddenWorlds& worlds, const rig::Campaign& world,
                const Diagnosis& diagnosis) {
  constexpr double kOfTheFloor = 1.05;
  Rate rate;
  if (!diagnosis::IsModelled(diagnosis.findings.front())) return rate;
  const auto& found = diagnosis.findings.front().score.candidate;
  const auto gain = diagnosis::HoldOut(CampaignOf(diagnosis, worlds.Recordings(world)),
                                       world.recordings, {found});
  if (gain.rows > 0) rate.Add(gain.after <= kOfTheFloor);
  return rate;
}

// Any cause, any object, any size, seen in these runs or not.
void RatesOfOneEffect(const HiddenWorlds& worlds) {
  const VisibleEffects visible(worlds);
  RateTable table;
  Rate at_floor;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x41DE);
    const std::string hidden = DrawHidden(random, 0, true);
    const auto world = worlds.Record(seed, {hidden});
    const rig::HiddenEffect& truth = world.hidden.front();
    const auto column = visible.ColumnOf({hidden}, seed);
    const double beside = visible.BesideRivals(column, NameOf(truth)),
                 showable = visible.ColumnOf({Largest(truth)}, seed).norm();
    fmt::print("[{:.1f} {:.1f} {:.1f}] ", column.norm(), beside, showable);
    const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
    if (IsOfData(truth)) {  // no columns: seen row by row or not at all
      table.Add(truth, 0.0, 0.0, RateTable::kSeen, diagnosis);
      return;
    }
    table.Add(truth, column.norm(), beside, showable, diagnosis);
    if (diagnosis.findings.size() == 1 && Names(diagnosis.findings.front(), truth)) {
      at_floor.Add(AtTheFloor(worlds, world, diagnosis));
    }
  });
  table.Print();
  fmt::print("held out, within 5 % of the noise: {}\n", at_floor.Text());
  EXPECT_GE(table.named_first.High(), 0.98);
  EXPECT_GE(table.inside.High(), 0.90);
  EXPECT_LE(table.inside.Low(), 0.99);
  EXPECT_LE(table.wrong_and_certain.Low(), 0.01);
  EXPECT_GE(table.listed.High(), 0.95);
  EXPECT_EQ(at_floor.met, at_floor.worlds);
}

TEST(HiddenRates, OfOneEffect) { RatesOfOneEffect(HiddenWorlds(kCampaign)); }

TEST(HiddenRates, OfOneEffectOnARougherMachine) {
  RatesOfOneEffect(HiddenWorlds(kCampaign).Unlike(kRougher));
}

TEST(HiddenRates, OfTwoEffects) {
  const HiddenWorlds worlds(kCampaign);
  const VisibleEffects visible(worlds);
  Rate both;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x2A1D);
    const std::vector<std::string> hidden{DrawHidden(random, 0, true), DrawHidden(random, 8, true)};
    const auto world = worlds.Record(seed, hidden);
    if (world.hidden[0].entry == world.hidden[1].entry) return;
    for (std::size_t i = 0; i < hidden.size(); ++i) {
      const auto column = visible.ColumnOf({hidden[i]}, seed);
      if (IsOfData(world.hidden[i])) return;
      if (visible.BesideRivals(column, NameOf(world.hidden[i])) <= RateTable::kSeen) return;
    }
    const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
    both.Add(std::all_of(world.hidden.begin(), world.hidden.end(), [&](const auto& effect) {
      return std::any_of(diagnosis.findings.begin(), diagnosis.findings.end(),
                         [&](const Finding& finding) { return Names(finding, effect); });
    }));
  });
  fmt::print("separable and both found: {}\n", both.Text());
  EXPECT_GE(both.High(), 0.90) << both.Text();
}

// An effect that no cause of the catalogue makes.
TEST(HiddenRates, OfUnknownEffects) {
  const HiddenWorlds worlds(kCampaign);
  const VisibleEffects visible(worlds);
  Rate right, wrong;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x0BAD);
    const std::string hidden = DrawHidden(random, 0, false);
    const auto world = worlds.Record(seed, {hidden});
    const double beside = visible.BesideRivals(visible.ColumnOf({hidden}, seed), "");
    fmt::print("[{:.1f}] ", beside);
    const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
    wrong.Add(diagnosis.verdict == Verdict::kExplained);
    if (beside <= RateTable::kSeen) return;
    right.Add(diagnosis.verdict == Verdict::kUnexplained &&
              LivesIn(diagnosis, rig::TruthOf(world.hidden)[0].at("variable")));
  });
  fmt::print("unexplained with the right variable: {}; a confident wrong name: {}\n", right.Text(),
             wrong.Text());
  EXPECT_GE(right.High(), 0.90) << right.Text();
  EXPECT_LE(wrong.Low(), 0.02) << wrong.Text();
}

// The same, however small: nothing of what is found is there.
TEST(HiddenRates, OfCertainNamesBesideUnknownEffects) {
  const HiddenWorlds worlds(kCampaign);
  Rate certain;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x0BAD);
    const Diagnosis diagnosis =
        DiagnosisOf(worlds, seed, worlds.Record(seed, {DrawHidden(random, 0, false)}));
    certain.Add(std::any_of(
        diagnosis.findings.begin(), diagnosis.findings.end(), [](const Finding& finding) {
          return diagnosis::IsModelled(finding) && finding.probability >= diagnosis::kCertain;
        }));
  });
  fmt::print("certain of what is not there: {}\n", certain.Text());
  EXPECT_LE(certain.Low(), 0.01) << certain.Text();
}

}  // namespace hidden_rates_test
}  // namespace abbe
