// Does the diagnosis find what the rig hides, and nothing where nothing is hidden?
// Worlds: ABBE_SEEDS, ABBE_SHARD.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/hidden_effects/hidden_world.h"
#include "tests/hidden_effects/judgement.h"
#include "tests/seeds.h"

namespace abbe {
namespace hidden_effects_test {

TEST(HiddenEffects, AreNotSeenWhereThereAreNone) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const Seeds seeds = SeedsFromEnvironment();
  Rate alarms;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    alarms.Add(DiagnosisOf(worlds, seed, worlds.Record(seed, {})).verdict != Verdict::kClean);
  }
  EXPECT_LE(alarms.Low(), 0.01) << alarms.Text();
}

// What a standard campaign shows far above its noise.
struct Shown {
  const char* hidden;
  std::vector<std::pair<std::string, double>> keys = {};
  // Not so: an outlier at the end of a motion is not seen, nor how the bearing is wound up between
  // two readings at a reversal.
  bool wholly = true;
};

class ShownEffects : public testing::TestWithParam<Shown> {};

TEST_P(ShownEffects, AreNamedFirstWithTheirSize) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const std::uint64_t seed = 3;
  const auto world = worlds.Record(seed, {GetParam().hidden});
  const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
  ASSERT_FALSE(diagnosis.findings.empty());
  const Finding& first = diagnosis.findings.front();
  EXPECT_TRUE(Names(first, world.hidden.front())) << first.score.candidate.Name();
  EXPECT_TRUE(diagnosis.verdict == Verdict::kExplained || !GetParam().wholly);
  const auto keys = KeysOf(first.score);
  for (const auto& [name, truth] : GetParam().keys) {
    for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
      const auto& key = first.score.candidate.cause->keys[static_cast<std::size_t>(i)];
      // 99.99 % of normal errors.
      if (key.name != name) continue;
      EXPECT_NEAR(keys.values[i] / key.unit, truth, 3.9 * keys.u[i] / key.unit);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    OfAStandardCampaign, ShownEffects,
    testing::Values(
        Shown{"backlash:object=X:width_um=6", {{"width_um", 6.0}}},
        Shown{"leadscrew-cyclic:object=Y:pitch_mm=6:amplitude_um=1:phase_rad=1",
              {{"pitch_mm", 6.0}, {"amplitude_um", 1.0}, {"phase_rad", 1.0}}},
        Shown{"joint-hysteresis:object=pivot_1:width_urad=30", {{"width_urad", 30.0}}, false},
        Shown{"reversal-spike:object=Y:height_um=4:decay_mm=0.6",
              {{"height_um", 4.0}, {"decay_mm", 0.6}}},
        Shown{"encoder-count-slip:object=pivot_3:time_s=839:angle_urad=50",
              {{"time_s", 839.0}, {"angle_urad", 50.0}}},  // between two runs
        Shown{"varying-backlash:object=Z:change_um=-9:bow_um=2",
              {{"change_um", -9.0}, {"bow_um", 2.0}}},
        Shown{"channel-sign:object=probe_d"}, Shown{"channel-swap:object=probe_d+probe_e"},
        Shown{"outliers:object=pivot_1:count=12", {}, false},
        Shown{"load-coupling:object=YZ:coefficient_nm_per_mm2=3",
              {{"coefficient_nm_per_mm2", 3.0}}},
        Shown{"cap-friction:object=cap:displacement_um=2", {{"displacement_um", 2.0}}},
        // Derivatives of two places in one fit had put a slip of an encoder beside it.
        Shown{"cap-friction:object=cap:displacement_um=0.882940829574997",
              {{"displacement_um", 0.882940829574997}}},
        Shown{"load-coupling:object=XY:coefficient_nm_per_mm2=2",
              {{"coefficient_nm_per_mm2", 2.0}}},
        Shown{"standing-position:object=Z:rms_um=1.5", {{"rms_um", 1.5}}},
        Shown{"mains-pickup:object=probe_b:frequency_hz=50:amplitude_um=0.2",
              {{"frequency_hz", 50.0}, {"amplitude_um", 0.2}}},
        Shown{"stuck-channel:object=probe_c"}));

class UnknownEffects : public testing::TestWithParam<Shown> {};

TEST_P(UnknownEffects, AreSaidToBeUnexplained) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const std::uint64_t seed = 5;
  const auto world = worlds.Record(seed, {GetParam().hidden});
  const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
  EXPECT_EQ(diagnosis.verdict, Verdict::kUnexplained);
  for (const Finding& finding : diagnosis.findings) {
    EXPECT_LT(finding.probability, diagnosis::kCertain) << finding.score.candidate.Name();
  }
}

// Up to four causes that are not there had been named on such a machine, at 0.9.
TEST(MachineUnlikeItsFile, IsNoCause) {
  const HiddenWorlds worlds = HiddenWorlds(rig::CampaignKind::kStandard).Unlike(kRougher);
  const std::uint64_t seed = 1;
  const auto world = worlds.Record(seed, {"backlash:object=X:width_um=3"});
  const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
  EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
  ASSERT_EQ(diagnosis.findings.size(), 1U);
  EXPECT_TRUE(Names(diagnosis.findings.front(), world.hidden.front()));
  ASSERT_EQ(diagnosis.notes.size(), 1U);
  EXPECT_NE(diagnosis.notes.front().find("population.smoothness_mm"), std::string::npos)
      << diagnosis.notes.front();
}

// Errors that are rough enough make a screw's wave too: on such machines it had been taken for
// their roughness, `clean` (study hidden, one-effect-rougher, seeds 29, 56, 78, 180, 186, 189 and 197).
TEST(MachineUnlikeItsFile, StillShowsItsScrew) {
  const HiddenWorlds worlds = HiddenWorlds(rig::CampaignKind::kStandard).Unlike(kRougher);
  const std::uint64_t seed = 189;
  const auto world = worlds.Record(
      seed, {"leadscrew-cyclic:object=X:pitch_mm=5.118:amplitude_um=3.548:phase_rad=4.664"});
  const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
  EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
  ASSERT_EQ(diagnosis.findings.size(), 1U);
  EXPECT_TRUE(Names(diagnosis.findings.front(), world.hidden.front()));
  Rate inside;
  AddSizes(diagnosis.findings.front(), world.hidden.front(), inside);
  EXPECT_EQ(inside.met, inside.worlds);
  EXPECT_GT(inside.worlds, 0);
}

// Six wrong causes, each at 1.000, had stood beside effects of this kind.
TEST(EffectsOfNoCatalogue, LeaveNothingToOtherNames) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  for (const auto& [seed, hidden, variable, object] :
       {std::tuple{3, "unknown-feed-square:object=X:height_um=8", "feed", "X"},
        std::tuple{2, "unknown-angle-bump:object=pivot_1", "pivot_1", "pivot_1"}}) {
    const auto world = worlds.Record(static_cast<std::uint64_t>(seed), {hidden});
    const Diagnosis diagnosis = DiagnosisOf(worlds, static_cast<std::uint64_t>(seed), world);
    EXPECT_TRUE(diagnosis.findings.empty()) << hidden;
    ASSERT_FALSE(diagnosis.leftovers.empty()) << hidden;
    // While Z stands, the straightness of Z along X is the positioning of X.
    const diagnosis::Leftover& left = diagnosis.leftovers.front();
    EXPECT_EQ(left.variable, variable);
    EXPECT_TRUE(left.object == object ||
                std::ranges::count(left.one_of, object, &diagnosis::Dependence::object) > 0)
        << hidden << ": " << left.object;
    EXPECT_LT(diagnosis.chi_after, 1.1) << hidden;
  }
}

INSTANTIATE_TEST_SUITE_P(OfAStandardCampaign, UnknownEffects,
                         testing::Values(Shown{"unknown-hum:object=probe_a"},
                                         Shown{"unknown-step-and-back:object=probe_d"}));

TEST(UnknownBorders, AreTold) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const std::uint64_t seed = 377;
  const auto world = worlds.Record(
      seed, {"unknown-step-and-back:object=probe_a:height_um=0.468:from_s=592.4:to_s=633.0"});
  const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
  constexpr double kCell = 1800.0 / 400.0;  // s
  // The zero of a probe is free in each run: what follows the interval may be told instead of it,
  // and which of them is hangs on rounding.
  std::string told;
  bool of_its_height = false;
  std::vector<double> borders;
  for (const diagnosis::Leftover& left : diagnosis.leftovers) {
    if (left.object != "probe_a" || left.variable != "time") continue;
    told +=
        fmt::format("{:.1f} to {:.1f} s: {:.3f} um\n", left.from, left.to, 1e6 * left.amplitude);
    borders.insert(borders.end(), {left.from, left.to});
    of_its_height = of_its_height || std::abs(left.amplitude - 0.468e-6) < 0.1e-6;
  }
  EXPECT_TRUE(of_its_height) << told;
  EXPECT_TRUE(std::ranges::any_of(borders, [&](double at) {
    return std::abs(at - 592.4) < kCell || std::abs(at - 633.0) < kCell;
  })) << told;
}

// Gap steps tell most by far, and stand at one place.
TEST(WhereItShows, IsOverTheWayThatTheAxisGoes) {
  const HiddenWorlds worlds(rig::CampaignKind::kFull);
  const std::uint64_t seed = 3;
  const auto world = worlds.Record(seed, {"leadscrew-cyclic:object=Y:pitch_mm=6:amplitude_um=1"});
  const Diagnosis diagnosis = DiagnosisOf(worlds, seed, world);
  ASSERT_FALSE(diagnosis.findings.empty());
  const diagnosis::Curve& curve = diagnosis.findings.front().curve;
  EXPECT_EQ(curve.variable, "y");
  ASSERT_GT(curve.at.size(), 24);
  EXPECT_GT(curve.at.maxCoeff() - curve.at.minCoeff(), 30e-3);
  const auto rms = [](const Eigen::VectorXd& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
  };
  // A wave of 1 um has 0.71 um rms, less what it loses over a part of 2.5 mm.
  EXPECT_NEAR(rms(curve.before), 0.6e-6, 0.2e-6);
  EXPECT_LT(rms(curve.after), 0.5 * rms(curve.before));
}

}  // namespace hidden_effects_test
}  // namespace abbe
