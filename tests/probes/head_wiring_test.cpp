// Wrong wires before the virtual rig are named, right ones are not.
#include "probes/head_wiring.h"

#include <gtest/gtest.h>

#include "tests/probes/align_worlds.h"

namespace abbe::probes::head_wiring_test {
namespace {

using Kind = Wiring::Kind;

// Set-ups in which all gaps are shown somewhere before anything is turned.
std::vector<std::uint64_t> Setups(const HeadSetup& setup, std::size_t count = 10) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = 1; seeds.size() < count; ++seed) {
    if (Operator(setup, BadlyMounted(), seed).CanRead()) seeds.push_back(seed);
  }
  return seeds;
}

// Reads, turns as prescribed, and reads again, until the wiring is named or three adjustments are
// done.
WiringFinding Follow(const HeadSetup& setup, std::uint64_t seed, Operator::Wires wires) {
  Operator person(setup, BadlyMounted(), seed, std::move(wires));
  for (int round = 0;; ++round) {
    for (bool half = true; !person.CanRead(); half = false) {
      person.Turn(half ? HalfBack(person.turned.back()) : person.turned.back());
    }
    person.Read();
    const WiringFinding found = FindWiring(person.readings, person.turned, setup.aligner);
    if (found.wrong.size() == 1 || round == 3) return found;
    const auto& last = person.readings.back();
    if (!found.wrong.empty()) {
      person.Turn({*TestTurn(found.wrong, last, setup.aligner)});
      continue;
    }
    const HeadAlignment aligned = setup.aligner.Evaluate(person.readings);
    // Only turns show all of the wiring.
    if (aligned.verdict == AlignVerdict::kReady && !person.turned.empty()) return found;
    person.Turn(aligned.turns);
  }
}

TEST(HeadWiring, RightWiresAreNeverNamed) {
  const HeadSetup setup;
  for (const std::uint64_t seed : Setups(setup, 200)) {
    const WiringFinding found = Follow(setup, seed, [](PerProbe<> gaps) { return gaps; });
    ASSERT_TRUE(found.wrong.empty()) << seed << ": " << NameOf(found.wrong.front());
  }
}

struct Tally {
  int named = 0, among = 0, other = 0;  // among: said not to be excluded, or one of several
  std::string missed = {};              // for the message
  void Count(const WiringFinding& found, const Wiring& truth) {
    if (found.wrong == std::vector{truth}) {
      ++named;
    } else if (std::ranges::count(found.wrong, truth) + std::ranges::count(found.open, truth) > 0) {
      ++among;
      missed += NameOf(truth) + " (" + std::to_string(found.wrong.size()) + "); ";
    } else {
      ++other;
    }
  }
};

TEST(HeadWiring, SwappedProbesAreNamed) {
  const HeadSetup setup;
  Tally tally;
  for (std::size_t i = 0; i < kProbes; ++i) {
    for (std::size_t k = i + 1; k < kProbes; ++k) {
      for (const std::uint64_t seed : Setups(setup)) {
        tally.Count(Follow(setup, seed,
                           [=](PerProbe<> gaps) {
                             std::swap(gaps[i], gaps[k]);
                             return gaps;
                           }),
                    {Kind::kSwapped, {i, k}});
      }
    }
  }
  EXPECT_EQ(tally.other, 0);
  EXPECT_GE(tally.named, 95) << tally.missed;
}

TEST(HeadWiring, WrongSignsAreNamed) {
  const HeadSetup setup;
  Tally tally;
  std::vector<std::vector<std::size_t>> groups = {{0, 1, 2}, {3, 4}, {0, 1, 2, 3, 4}};
  for (std::size_t i = 0; i < kProbes; ++i) groups.push_back({i});
  for (const auto& group : groups) {
    for (const std::uint64_t seed : Setups(setup)) {
      tally.Count(Follow(setup, seed,
                         [&](PerProbe<> gaps) {
                           for (const std::size_t i : group) gaps[i] = 200e-6 - gaps[i];
                           return gaps;
                         }),
                  {Kind::kInverted, group});
    }
  }
  EXPECT_EQ(tally.other, 0);
  EXPECT_GE(tally.named, 75) << tally.missed;
}

TEST(HeadWiring, ProbesThatDoNotMoveAreNamed) {
  const HeadSetup setup;
  Tally tally;
  for (std::size_t i = 0; i < kProbes; ++i) {
    for (const std::uint64_t seed : Setups(setup)) {
      tally.Count(Follow(setup, seed,
                         [=](PerProbe<> gaps) {
                           gaps[i] = 64e-6;
                           return gaps;
                         }),
                  {Kind::kUnmoved, {i}});
    }
  }
  EXPECT_EQ(tally.other, 0);
  EXPECT_GE(tally.named, 47) << tally.missed;
}

// Two probes that look at one face: the travel cannot say which of them has the wrong sign.
TEST(HeadWiring, RivalsAreSeparatedByATestTurn) {
  const HeadSetup setup;
  std::vector<GapsAt> readings;
  for (const double travel : {0.0, 60e-3}) {
    GapsAt at{.travel = travel, .gap = {100e-6, 100e-6, 100e-6, 80e-6, 120e-6}};
    at.gap[3] += 5e-4 * travel;
    at.gap[4] -= 5e-4 * travel;
    readings.push_back(at);
  }
  const WiringFinding found = FindWiring(readings, {}, setup.aligner);
  EXPECT_GE(std::ranges::count(found.wrong, Wiring{Kind::kInverted, {3}}), 1);
  EXPECT_GE(std::ranges::count(found.wrong, Wiring{Kind::kInverted, {4}}), 1);
  const auto turn = TestTurn(found.wrong, readings.back(), setup.aligner);
  ASSERT_TRUE(turn);
  EXPECT_TRUE(setup.settings.screws[turn->screw].name.starts_with("side"));
  // It closes or opens the gaps of both by 20 um at most. D shows the wrong sign:
  const ScrewResponse response = setup.aligner.screws().At(60e-3);
  const double moved = turn->turns * setup.settings.screws[turn->screw].pitch;
  EXPECT_LE(
      std::abs(moved) * response.col(static_cast<Eigen::Index>(turn->screw)).cwiseAbs().maxCoeff(),
      20.1e-6);
  for (std::size_t place = 0; place < 2; ++place) {
    GapsAt at = readings[place];
    at.setting = 1;
    const ScrewResponse there = setup.aligner.screws().At(at.travel);
    for (std::size_t i = 0; i < kProbes; ++i) {
      at.gap[i] += (i == 3 ? -1.0 : 1.0) * moved *
                   there(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(turn->screw));
    }
    readings.push_back(at);
  }
  const std::vector<std::vector<ScrewTurn>> turned = {{*turn}};
  EXPECT_EQ(FindWiring(readings, turned, setup.aligner).wrong,
            (std::vector<Wiring>{{Kind::kInverted, {3}}}));
}

TEST(HeadWiring, Names) {
  EXPECT_EQ(NameOf({Kind::kSwapped, {1, 2}}), "probe_b and probe_c are swapped");
  EXPECT_EQ(NameOf({Kind::kInverted, {0}}), "the sign of probe_a is wrong");
  EXPECT_EQ(NameOf({Kind::kInverted, {0, 1, 2}}),
            "the signs of probe_a, probe_b and probe_c are wrong");
  EXPECT_EQ(NameOf({Kind::kUnmoved, {4}}), "probe_e does not move with the target");
}

}  // namespace
}  // namespace abbe::probes::head_wiring_test
