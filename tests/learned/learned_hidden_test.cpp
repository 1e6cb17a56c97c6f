// Effects that are in no catalogue, learned: the right stage, variable, form and size.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/learned/hidden_terms.h"
#include "tests/learned/learned_world.h"

namespace abbe {
namespace learned_hidden_test {

using namespace hidden_terms;

class LearnedTerms : public testing::TestWithParam<HiddenTerm> {};

TEST_P(LearnedTerms, AreRight) {
  const HiddenTerm& hidden = GetParam();
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  constexpr std::uint64_t kSeed = 5;
  const auto [diagnosis, learning] =
      LearnedFrom(worlds, kSeed, worlds.RecordEffects(kSeed, EffectsOf(hidden, kSeed)));
  ASSERT_EQ(diagnosis.verdict, Verdict::kLearned);
  ASSERT_EQ(learning.terms.size(), 1U);
  const learned::Learned& learned = learning.terms.front();
  EXPECT_TRUE(learned.IsFound());
  const simulation::LearnedTerm& term = learned.term();
  EXPECT_NE(std::ranges::find(hidden.stages, term.object), hidden.stages.end()) << term.object;
  EXPECT_TRUE(term.expression.Text().starts_with(hidden.form)) << term.expression.Text();
  EXPECT_NEAR(1e6 * term.coefficients[0], hidden.size, 2e6 * std::sqrt(term.covariance(0, 0)));
  EXPECT_LT(learning.chi_after, 1.1);
}

INSTANTIATE_TEST_SUITE_P(
    OfTheRig, LearnedTerms,
    testing::Values(
        HiddenTerm{&kStep,
                   "Y",
                   {1, 0},
                   {{"height_um", 3.0}, {"at_mm", 31.4}},
                   StagesOf(1),
                   {"x"},
                   "step(x - ",
                   3.0},
        HiddenTerm{&kKink,
                   "probe_b",
                   {1},
                   {{"height_um", 3.0}, {"from_s", 250.0}},
                   {"probe_b"},
                   {"time"},
                   "max(0, time - ",
                   0.003},
        HiddenTerm{&kDecay,
                   "probe_c",
                   {2},
                   {{"height_um", 1.0}, {"fades_s", 30.0}},
                   {"probe_c"},
                   {"time of run"},
                   "exp(-time of run / ",
                   1.0},
        HiddenTerm{
            &kSpeed, "X", {0}, {{"height_um", 8.0}}, StagesOf(0), {"feed"}, "feed^2", 8.0 / 36e4}),
    [](const auto& each) {
      std::string name(each.param.effect->name);
      std::erase(name, '-');
      return name;
    });

}  // namespace learned_hidden_test
}  // namespace abbe
