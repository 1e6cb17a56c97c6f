// How often a learned term is right, over many worlds, each row by itself (--gtest_filter). Worlds
// of a row: ABBE_SEEDS, ABBE_SHARD.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "study/hidden/visible_effects.h"
#include "tests/learned/hidden_terms.h"
#include "tests/learned/learned_world.h"
#include "tests/seeds.h"

namespace abbe {
namespace learned_rates_test {

constexpr auto kCampaign = rig::CampaignKind::kStandard;
constexpr double kSeen = 5.0;  // standard deviations beside the best rival

void ForEachSeed(const std::function<void(std::uint64_t seed)>& use) {
  const Seeds seeds = SeedsFromEnvironment();
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) use(seed);
}

bool HasFound(const LearnedWorld& world) {
  return std::ranges::any_of(world.learning.terms,
                             [](const learned::Learned& term) { return term.IsFound(); });
}

Rate CleanWorldsWithATerm(const HiddenWorlds& worlds) {
  Rate terms;
  ForEachSeed([&](std::uint64_t seed) {
    terms.Add(HasFound(LearnedFrom(worlds, seed, worlds.Record(seed, {}))));
  });
  fmt::print("clean worlds with a learned term: {}\n", terms.Text());
  return terms;
}

TEST(LearnedRates, OfCleanWorldsInWhiteNoise) {
  EXPECT_LE(CleanWorldsWithATerm(HiddenWorlds(kCampaign, HiddenWorlds::Noise::kWhite)).Low(), 0.01);
}

TEST(LearnedRates, OfCleanWorldsInNoiseThatDrifts) {
  EXPECT_LE(CleanWorldsWithATerm(HiddenWorlds(kCampaign)).Low(), 0.01);
}

// An effect of the catalogue, any object, any size.
TEST(LearnedRates, OfNamedCauses) {
  const HiddenWorlds worlds(kCampaign);
  Rate instead;
  ForEachSeed([&](std::uint64_t seed) {
    const random::CounterRandom random(seed, 0x41DE);
    const auto world = worlds.Record(seed, {DrawHidden(random, 0, true)});
    instead.Add(HasFound(LearnedFrom(worlds, seed, world)));
  });
  fmt::print("named causes with a learned term: {}\n", instead.Text());
  EXPECT_LE(instead.Low(), 0.01);
}

// Effects of the test's own, in the grammar and wider.
class Judge {
 public:
  void Add(const HiddenTerm& hidden, double sd, const LearnedWorld& world) {
    const bool in_grammar = !hidden.form.empty();
    const auto& terms = world.learning.terms;
    const bool learned = world.diagnosis.verdict == Verdict::kLearned;
    const bool named_wrong = world.diagnosis.verdict == Verdict::kExplained;
    if (!in_grammar) {
      const bool told_as_expression =
          learned && std::ranges::any_of(terms, [](const auto& term) { return !term.is_smooth; });
      outside_.Add(!named_wrong && !told_as_expression);
      return;
    }
    named_wrong_.Add(named_wrong);
    if (sd <= kSeen) return;
    certified_.Add(learned);
    const auto is_right = [&](const learned::Learned& term) {
      const auto variables = term.term().expression.Variables();
      return std::ranges::find(hidden.stages, term.term().object) != hidden.stages.end() &&
             std::set<std::string>(variables.begin(), variables.end()) == hidden.variables;
    };
    const auto right = std::ranges::find_if(terms, is_right);
    place_.Add(right != terms.end());
    for (const auto& term : terms) {
      if (!term.IsFound()) continue;
      ++told_;
      told_right_ += is_right(term) ? 1 : 0;
    }
    ++truths_;
    if (right == terms.end()) return;
    const simulation::LearnedTerm& term = right->term();
    const bool form = term.expression.Text().starts_with(hidden.form);
    form_.Add(form);
    if (!form) return;
    inside_.Add(std::abs(1e6 * term.coefficients[0] - hidden.size) <=
                2e6 * std::sqrt(term.covariance(0, 0)));
    if (learned && term.certificate.heldout_after > 0.0) {
      at_floor_.Add(term.certificate.heldout_after < 1.05);
    }
  }

  void Print() const {
    const double precision = told_ > 0 ? static_cast<double>(told_right_) / told_ : 0.0,
                 recall = truths_ > 0 ? static_cast<double>(told_right_) / truths_ : 0.0;
    fmt::print(
        "above 5 sd: verdict learned {}; stage, object and variable {}; F1 {:.3f} (precision {:.3f}, "
        "recall {:.3f}); form {}; size inside U95 {}; held out within 5 % of the noise {}; a named "
        "cause {}; outside the grammar, smooth or unexplained {}\n",
        certified_.Text(), place_.Text(), 2.0 * precision * recall / (precision + recall),
        precision, recall, form_.Text(), inside_.Text(), at_floor_.Text(), named_wrong_.Text(),
        outside_.Text());
  }

  Rate certified_, place_, form_, inside_, at_floor_, named_wrong_, outside_;
  int told_ = 0, told_right_ = 0, truths_ = 0;
};

TEST(LearnedRates, OfEffectsOfNoCatalogue) {
  const HiddenWorlds worlds(kCampaign);
  const study::VisibleEffects visible(worlds);
  Judge judge;
  ForEachSeed([&](std::uint64_t seed) {
    const HiddenTerm hidden = DrawTerm(seed, static_cast<int>((seed - 1) % kTermKinds));
    const auto world = worlds.RecordEffects(seed, EffectsOf(hidden, seed));
    const double sd = visible.BesideRivals(
        visible.ColumnOfWorld(worlds.WithoutCounts().RecordEffects(seed, EffectsOf(hidden, seed)),
                              seed),
        "");
    fmt::print("[{:.1f} {} {} size {:.3g}] ", sd, hidden.effect->name, hidden.object, hidden.size);
    judge.Add(hidden, sd, LearnedFrom(worlds, seed, world));
  });
  judge.Print();
  EXPECT_GE(judge.place_.High(), 0.9);
  EXPECT_GE(judge.form_.High(), 0.8);
  EXPECT_GE(judge.inside_.High(), 0.9);
  EXPECT_LE(judge.named_wrong_.Low(), 0.01);
  EXPECT_GE(judge.outside_.High(), 0.99);
}

}  // namespace learned_rates_test
}  // namespace abbe
