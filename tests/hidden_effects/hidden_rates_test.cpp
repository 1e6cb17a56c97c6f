// How often the diagnosis is wrong and certain. Worlds: ABBE_SEEDS, ABBE_SHARD.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/hidden_effects/judgement.h"
#include "tests/seeds.h"

namespace abbe {
namespace {

// Any cause, any object, any size, seen in these runs or not.
TEST(HiddenRates, OfNamesThatAreWrongAndCertain) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const Seeds seeds = SeedsFromEnvironment();
  Rate wrong, named, clean;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const random::CounterRandom random(seed, 0x41DE);
    const auto world = worlds.Record(seed, {DrawHidden(random, 0, true)});
    const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
    const bool right =
        !diagnosis.findings.empty() && Names(diagnosis.findings.front(), world.hidden.front());
    wrong.Add(diagnosis.verdict == Verdict::kExplained && !right);
    named.Add(right);
    clean.Add(diagnosis.verdict == Verdict::kClean);
  }
  fmt::print("named first: {}; clean: {}; wrong and certain: {}\n", named.Text(), clean.Text(),
             wrong.Text());
  EXPECT_LE(wrong.Low(), 0.01) << wrong.Text();
}

}  // namespace
}  // namespace abbe
