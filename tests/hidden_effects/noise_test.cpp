// Worlds of the rig whose noise is not as the machine file says: of each channel its own, with a
// memory, far too much of it, or no noise but a line in time within the stays of sweeps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "random/counter_random.h"
#include "tests/hidden_effects/judgement.h"

namespace abbe {
namespace noise_test {

constexpr double kStatedProbe = 0.02;    // um, of the machine file
constexpr double kStatedEncoder = 3e-6;  // rad

const std::array<std::string, 5> kProbes{"probe_a_um", "probe_b_um", "probe_c_um", "probe_d_um",
                                         "probe_e_um"};
const std::array<std::string, 3> kPivots{"pivot_1_rad", "pivot_2_rad", "pivot_3_rad"};

// Noise of this deviation, of which each reading keeps so much in the next.
void AddNoise(rig::Campaign& world, const std::string& column, std::uint64_t stream, double sd,
              double kept = 0.0) {
  std::uint64_t index = 0;
  const random::CounterRandom random(17, stream);
  for (auto& recording : world.recordings) {
    double now = random.Normal(index++);
    for (auto& each : recording.columns) {
      if (each.name != column) continue;
      for (double& value : each.values) {
        now = kept * now + std::sqrt(1.0 - kept * kept) * random.Normal(index++);
        value += sd * now;
      }
    }
  }
}

// White noise as stated; `factors` of each probe.
rig::Campaign World(const HiddenWorlds& worlds, std::uint64_t seed,
                    const std::vector<std::string>& hidden = {},
                    const std::array<double, 5>& factors = {1, 1, 1, 1, 1}, double kept = 0.0) {
  rig::Campaign world = worlds.Quiet().Record(seed, hidden);
  for (std::size_t i = 0; i < 5; ++i) {
    AddNoise(world, kProbes[i], 10 * seed + i, factors[i] * kStatedProbe);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    AddNoise(world, kPivots[i], 10 * seed + 5 + i, kStatedEncoder, kept);
  }
  return world;
}

std::string Told(const Diagnosis& diagnosis) {
  std::string text(Name(diagnosis.verdict));
  for (const Finding& finding : diagnosis.findings) {
    text += fmt::format("; {} {:.3f}", finding.score.candidate.Name(), finding.probability);
  }
  for (const auto& left : diagnosis.leftovers) {
    text += fmt::format("; {} over {}", left.object, left.variable);
  }
  return text;
}

TEST(HiddenNoise, OfFiveUnequalProbesHasNoCauseAndScattersAsMeasured) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  for (const std::uint64_t seed : {301u, 302u}) {
    const auto world = World(worlds, seed, {}, {0.5, 0.8, 1.1, 1.5, 2.0});
    const Diagnosis diagnosis = diagnosis::Diagnose(worlds.Recordings(world));
    EXPECT_TRUE(diagnosis.findings.empty()) << Told(diagnosis);
    EXPECT_FALSE(std::ranges::any_of(diagnosis.leftovers, [](const auto& left) {
      return left.variable == diagnosis::kScatter || left.variable == diagnosis::kMemory;
    })) << Told(diagnosis);
  }
}

TEST(HiddenNoise, OfEncodersWithAMemoryIsClean) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  for (const double steps : {3.0, 10.0, 30.0}) {
    const auto world = World(worlds, 303, {}, {1, 1, 1, 1, 1}, std::exp(-1.0 / steps));
    const Diagnosis diagnosis = diagnosis::Diagnose(worlds.Recordings(world));
    EXPECT_EQ(diagnosis.verdict, Verdict::kClean) << steps << ": " << Told(diagnosis);
    EXPECT_THAT(diagnosis.notes, testing::Contains(testing::HasSubstr("goes on"))) << steps;
  }
}

TEST(HiddenNoise, FarBeyondTheStatedIsNeverClean) {
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  const auto world = World(worlds, 304, {}, {1, 1, 10, 1, 1});
  const Diagnosis diagnosis = diagnosis::Diagnose(worlds.Recordings(world));
  EXPECT_EQ(diagnosis.verdict, Verdict::kUnexplained);
  EXPECT_TRUE(std::ranges::any_of(diagnosis.leftovers, [](const auto& left) {
    return left.object == "probe_c" && left.variable == diagnosis::kAtRest &&
           std::abs(left.amplitude - 10.0) < 1.0;
  })) << Told(diagnosis);
}

// A minimal campaign has no standstill: the means of its stays hold little of a line.
TEST(HiddenNoise, IsNoneWhereALineIsInTheStaysOfASweep) {
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  const rig::Campaign mains =
      World(worlds, 305, {"mains-pickup:object=probe_d:frequency_hz=50:amplitude_um=0.15"});
  const Diagnosis picked_up = diagnosis::Diagnose(worlds.Recordings(mains));
  ASSERT_FALSE(picked_up.findings.empty()) << Told(picked_up);
  const Finding& finding = picked_up.findings.front();
  EXPECT_EQ(finding.score.candidate.Name(), "mains-pickup:probe_d") << Told(picked_up);
  const auto keys = diagnosis::KeysOf(finding.score);
  EXPECT_NEAR(std::abs(keys.values[1]), 0.15e-6, 4.0 * keys.u[1]);
  EXPECT_LT(keys.u[1], 0.03e-6);  // the deviation of its draws

  const rig::Campaign vibrates =
      World(worlds, 306, {"vibration:object=Y:frequency_hz=4.07:amplitude_um=0.15"});
  const Diagnosis told = diagnosis::Diagnose(worlds.Recordings(vibrates));
  EXPECT_NE(told.verdict, Verdict::kClean) << Told(told);
  EXPECT_TRUE(std::ranges::any_of(told.findings, [&](const Finding& each) {
    return each.score.candidate.Name() == "vibration:Y";
  })) << Told(told);
}

}  // namespace noise_test
}  // namespace abbe
