// The zero of one probe jumps in mid-run, or warms up.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/probes/changed_sweep.h"

namespace abbe::probes {
namespace zero_jump_test {

SyntheticSweep ThreePasses(std::uint64_t seed, double drift = 30e-9) {
  return {.stations = 13, .passes = 3, .samples = 10, .white = 20e-9, .drift = drift, .seed = seed};
}

SweepResult Jumping(const SyntheticSweep& sweep, double um, double at) {
  const SweepSetup setup = SetupOfNoiseOnly();
  return ReduceSweep(WithAdded(Record(sweep, setup),
                               [&](std::size_t probe, double share) {
                                 return probe == 0 && share > at ? um : 0.0;
                               }),
                     setup);
}

TEST(ZeroJump, IsTakenOutAndNamed) {
  const SweepSetup setup = SetupOfNoiseOnly();
  for (const double um : {1.0, -0.3, 20.0}) {
    InsideU95 inside;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const SyntheticSweep sweep = ThreePasses(seed);
      // In one of the six halves of passes, apart from their turns.
      const double at =
          (static_cast<double>(seed % 6) + 0.15 + 0.055 * static_cast<double>(seed)) / 6.0;
      const SweepResult result = Jumping(sweep, um, at);
      inside.Add(sweep, result);
      EXPECT_TRUE(Tells(result, "the zero of probe_a jumps by ")) << um << " " << seed;
      EXPECT_FALSE(Tells(result, "the zero of probe_b")) << um << " " << seed;
      const SweepResult sound = ReduceSweep(Record(sweep, setup), setup);
      // Yaw and EYX know nothing of probe A.
      for (const std::size_t c : {std::size_t{2}, std::size_t{3}}) {
        EXPECT_LT(result.components[c].u[6], 1.5 * sound.components[c].u[6]) << um << " " << seed;
      }
    }
    EXPECT_GT(inside.share(), 0.92) << um;
  }
}

// The time and the size are those that were put in.
TEST(ZeroJump, TheNoteSaysWhenAndHowLarge) {
  const SyntheticSweep sweep = ThreePasses(5);
  const SweepResult result = Jumping(sweep, 1.0, 0.45);
  std::string told;
  for (const std::string& note : result.notes) {
    if (note.starts_with("the zero of probe_a jumps by ")) told = note;
  }
  ASSERT_NE(told, "");
  EXPECT_NEAR(std::stod(told.substr(29)), 1.0, 0.05);
  const double whole = 78.0 * (12 + 20 + 10) * 0.005;  // s: 78 dwells
  EXPECT_NEAR(std::stod(told.substr(told.find("about ") + 6)), 0.45 * whole, 0.3);
  EXPECT_NE(told.find("pass 2"), std::string::npos);
}

// What happens at a turn may be halves of passes that scatter: u follows, and no probe is named.
TEST(ZeroJump, AtATurnIsScatter) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SyntheticSweep sweep = ThreePasses(seed);
    const SweepResult result = Jumping(sweep, 0.3, 0.5);
    EXPECT_FALSE(Tells(result, "the zero of probe")) << seed;
    EXPECT_TRUE(Tells(result, "the passes scatter")) << seed;
  }
}

// Probes that warm up, most of it in the first of three passes: as an exponential, and slower at
// the end than one.
TEST(WarmingUp, IsTakenOutAndNamed) {
  const SweepSetup setup = SetupOfNoiseOnly();
  constexpr std::array<double, kProbes> kSizes{2.0, -1.0, 1.5, 0.7, -2.0};  // um
  for (const bool slower : {false, true}) {
    InsideU95 inside;
    double times = 0.0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const SyntheticSweep sweep = ThreePasses(seed);
      const SweepResult result =
          ReduceSweep(WithAdded(Record(sweep, setup),
                                [&](std::size_t probe, double share) {
                                  const double fast = -std::expm1(-4.0 * share);
                                  const double slow = -std::expm1(-share / 0.8);
                                  return kSizes[probe] * (slower ? 0.7 * fast + 0.3 * slow : fast);
                                }),
                      setup);
      inside.Add(sweep, result);
      for (const char probe : {'a', 'b', 'c', 'd', 'e'}) {
        EXPECT_TRUE(Tells(
            result, fmt::format("the zero of probe_{} drifts like one that warms up, by ", probe)))
            << seed;
      }
      const SweepResult sound = ReduceSweep(Record(sweep, setup), setup);
      times += result.components[2].u[6] / sound.components[2].u[6] / 12.0;
    }
    EXPECT_GT(inside.share(), 0.92) << slower;
    EXPECT_LT(times, slower ? 10.0 : 2.0);
  }
}

// Its time and size are those that were put in, and a probe that does not warm up is not named.
TEST(WarmingUp, TheNoteSaysHowLongAndHowFar) {
  const SweepSetup setup = SetupOfNoiseOnly();
  const SweepResult result =
      ReduceSweep(WithAdded(Record(ThreePasses(5), setup),
                            [&](std::size_t probe, double share) {
                              return probe == 0 ? -std::expm1(-4.0 * share) : 0.0;
                            }),
                  setup);
  std::string told;
  for (const std::string& note : result.notes) {
    if (note.starts_with("the zero of probe_a drifts like one that warms up, by ")) told = note;
    EXPECT_FALSE(note.starts_with("the zero of probe_b")) << note;
  }
  ASSERT_NE(told, "");
  EXPECT_NEAR(std::stod(told.substr(told.find(", by ") + 5)), 1.0, 0.1);
  const double whole = 78.0 * (12 + 20 + 10) * 0.005;  // s: 78 dwells
  EXPECT_NEAR(std::stod(told.substr(told.find("constant of ") + 12)), whole / 4.0, 0.1 * whole / 4);
}

// A drift that wanders far more than stated is no jump.
TEST(ZeroJump, IsNotSeenInADrift) {
  const SweepSetup setup = SetupOfNoiseOnly();
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const double drift : {30e-9, 300e-9}) {
      const SweepResult result = ReduceSweep(Record(ThreePasses(seed, drift), setup), setup);
      EXPECT_FALSE(Tells(result, "the zero of probe")) << seed << " " << drift;
    }
  }
}

}  // namespace zero_jump_test
}  // namespace abbe::probes
