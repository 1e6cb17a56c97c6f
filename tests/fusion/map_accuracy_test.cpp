// Is the map as uncertain as it says, and how good are the instruments apart and together? One
// world of the virtual rig a seed, one random point, tool and component of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "random/counter_random.h"
#include "study/bound/rig_map_bound.h"
#include "tests/fusion/rig_campaign.h"
#include "tests/pull_statistics.h"
#include "tests/seeds.h"

namespace abbe::fusion {
namespace map_accuracy_test {

using Eigen::Vector3d;
using simulation::SimulatedRun;

constexpr double kCoverage = 1.96;
constexpr double kTool = 0.05;  // m: largest coordinate of the tool vector
constexpr int kPoints = 40;     // of the rms over the volume

struct Set {
  std::string name;
  bool sweeps, linkage, length;
  Pulls pulls = {};
  Mean square = {}, variance = {};  // 3D with the ball as tool, m^2; the mean of each machine
  double bound = 0.0;               // of the square
};

Vector3d Draw(const random::CounterRandom& random, std::uint64_t first, double low, double high) {
  return {random.Uniform(first, low, high), random.Uniform(first + 1, low, high),
          random.Uniform(first + 2, low, high)};
}

void Judge(const Campaign& campaign, const FuseReport& report, std::uint64_t seed, Set& set) {
  const random::CounterRandom random(seed, 0x3A9);
  const Vector3d at = Draw(random, 0, 0.0, 0.06), tool = Draw(random, 3, -kTool, kTool);
  const auto component = static_cast<Eigen::Index>(3.0 * random.Uniform(6, 0.0, 1.0));
  const Vector3d off = report.map.Error(at, tool) - campaign.TrueError(at, tool);
  set.pulls.Add(off[component], report.map.StandardUncertainty(at, tool)[component], kCoverage);
  Mean square, variance;
  for (int i = 0; i < kPoints; ++i) {
    const Vector3d place = Draw(random, 10 + 3 * static_cast<std::uint64_t>(i), 0.0, 0.06);
    const Vector3d none = Vector3d::Zero();
    square.Add((report.map.Error(place, none) - campaign.TrueError(place)).squaredNorm());
    variance.Add(report.map.StandardUncertainty(place, none).squaredNorm());
  }
  set.square.Add(square.mean());
  set.variance.Add(variance.mean());
}

// The same recordings on the machine without errors: the bound of a Gaussian does not depend on
// what was drawn.
study::RigMapBound BoundOf(const settings::Document& document, const Campaign& campaign) {
  constexpr int kPlaces = 60;
  const random::CounterRandom random(1, 0x3AA);
  Eigen::Matrix3Xd places(3, kPlaces);
  for (int i = 0; i < kPlaces; ++i) {
    places.col(i) = Draw(random, 3 * static_cast<std::uint64_t>(i), 0.0, 0.06);
  }
  study::RigMapBound bound(rig::ReadRigSettings(document.Root()), rig::ReadLinkage(document.Root()),
                           places);
  for (const char axis : {'X', 'Y', 'Z'}) bound.Add(campaign.SweepRecording(axis));
  bound.Add(campaign.LinkageRecording());
  bound.Add(campaign.LengthRecording('X'));
  return bound;
}

TEST(MapAccuracy, StatesTrueUncertaintiesAndGainsFromTheOtherInstrument) {
  const settings::Document document = CampaignMachine();
  std::array<Set, 4> sets{Set{"sweeps", true, false, false}, Set{"RELM", false, true, false},
                          Set{"RELM + sweeps", true, true, false},
                          Set{"RELM + sweeps + length", true, true, true}};
  const Seeds seeds = SeedsFromEnvironment();
  const study::RigMapBound bound = BoundOf(document, Campaign(document, 1));
  for (Set& set : sets) set.bound = bound.Variance({set.sweeps, set.linkage, set.length});
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; seed += seeds.step) {
    const Campaign campaign(document, seed);
    const std::vector<SimulatedRun> sweeps{campaign.Sweep('X'), campaign.Sweep('Y'),
                                           campaign.Sweep('Z')};
    const SimulatedRun linkage = campaign.Linkage(), length = campaign.Length('X');
    for (Set& set : sets) {
      std::vector<SimulatedRun> runs;
      if (set.sweeps) runs = sweeps;
      if (set.linkage) runs.push_back(linkage);
      if (set.length) runs.push_back(length);
      Judge(campaign, Fuse(campaign.machine, runs, {.choose_smoothness = false}), seed, set);
    }
  }
  fmt::print("{:<24}{:>10}{:>10}{:>10}{:>12}{:>12}{:>10}\n", "data", "rms um", "stated", "bound",
             "mean pull", "variance", "in U95");
  for (const Set& set : sets) {
    fmt::print("{:<24}{:>10.3f}{:>10.3f}{:>10.3f}{:>12.3f}{:>12.3f}{:>9.1f}%\n", set.name,
               1e6 * std::sqrt(set.square.mean()), 1e6 * std::sqrt(set.variance.mean()),
               1e6 * std::sqrt(set.bound), set.pulls.pull.mean(), set.pulls.square.mean(),
               100.0 * set.pulls.inside.mean());
    SCOPED_TRACE(set.name);
    set.pulls.ExpectTrueUncertainties();
    // A tenth of the root, and the scatter of so many machines.
    const double scatter = k99 * set.square.error();
    EXPECT_LT(set.square.mean() - scatter, 1.21 * set.bound);
    EXPECT_GT(set.square.mean() + scatter, 0.81 * set.bound);
    // What is stated scatters little and needs no allowance.
    EXPECT_NEAR(std::sqrt(set.variance.mean() / set.bound), 1.0, 0.1);
  }
  // Stated, and held to be true above: the scatter of few worlds is larger than the margin.
  const double best_alone = std::min(sets[0].variance.mean(), sets[1].variance.mean());
  EXPECT_GT(std::sqrt(best_alone / sets[3].variance.mean()), 3.0);
}

}  // namespace map_accuracy_test
}  // namespace abbe::fusion
