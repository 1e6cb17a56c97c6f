// A gain that plain sweeps cannot tell from a crosstalk: a sweep with two cables exchanged can, for
// the gain of the channel then acts on the other probe. As planned, and as the rig records it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "diagnosis/evidence.h"
#include "diagnosis/expected_odds.h"
#include "diagnosis/linear_runs.h"
#include "diagnosis/run_catalogue.h"
#include "rig/record_sweep.h"
#include "simulation/causes/registry.h"
#include "tests/hidden_effects/judgement.h"

namespace abbe {
namespace swapped_cables_test {

constexpr std::uint64_t kSeed = 95;
constexpr const char* kLater = "2026-11-21T12:00:00Z";

std::vector<recording::Recording> SweepsOf(const rig::Campaign& world) {
  std::vector<recording::Recording> sweeps;
  std::ranges::copy_if(world.recordings, std::back_inserter(sweeps),
                       [](const auto& each) { return each.Kind() == "sweep"; });
  return sweeps;
}

// A sweep of X, its channels d and e exchanged before their amplifiers. The amplifier of d is that
// with the gain, so the rig's gain sits in probe e, whose column is then named d.
recording::Recording Swapped(const HiddenWorlds& worlds, const std::string& gain) {
  rig::CampaignMachine machine = worlds.machine();
  rig::ThinSweeps(machine, 7);
  const rig::World world(machine.rig, kSeed,
                         {rig::ParseHidden("probe-gain:object=probe_e:delta=" + gain, kSeed, {})});
  recording::Recording sweep =
      rig::RecordSweep(world, 'X', machine.channels,
                       {.rate = 20.0,
                        .moving = false,
                        .run = 77,
                        .mounting = "first",
                        .started = kLater,
                        .more = "head = \"0deg\"\nswapped = \"probe_d+probe_e\"\n"});
  for (auto& column : sweep.columns) {
    if (column.name == "probe_d_um") {
      column.name = "probe_e_um";
    } else if (column.name == "probe_e_um") {
      column.name = "probe_d_um";
    }
  }
  sweep.name = "swapped";
  return sweep;
}

diagnosis::Campaign CampaignOf(const HiddenWorlds& worlds,
                               const std::vector<recording::Recording>& recordings) {
  diagnosis::Campaign campaign(worlds.setup());
  for (const auto& recording : recordings) campaign.Add(recording);
  return campaign;
}

const std::vector<diagnosis::Candidate>& Rivals() {
  static const std::vector<diagnosis::Candidate> rivals{
      {&simulation::CauseNamed("probe-gain"), "probe_d", {}},
      {&simulation::CauseNamed("probe-crosstalk"), "probe_d+probe_e", {}}};
  return rivals;
}

// What the data say for the gain against the crosstalk.
double ShownBy(const diagnosis::Campaign& campaign) {
  const auto scores = diagnosis::ScoreAll(diagnosis::Fit(campaign), Rivals());
  return scores[0].log_evidence - scores[1].log_evidence;
}

// What they are expected to say of a gain of 5 %.
double ExpectedOf(const diagnosis::LinearRuns& linear, std::size_t runs) {
  std::vector<diagnosis::RunSums> sums;
  for (std::size_t run = 0; run < runs; ++run) {
    sums.push_back(linear.SumsOf(linear.At(run), Rivals()));
  }
  const auto evidence =
      diagnosis::ExpectedEvidence(linear.Information(diagnosis::PointersTo(sums)),
                                  {{Rivals()[0], Eigen::VectorXd::Constant(1, 0.05), 0.5},
                                   {Rivals()[1], Eigen::VectorXd::Zero(1), 0.5}},
                                  0);
  return evidence[0] - evidence[1];
}

TEST(SwappedCables, TellAGainFromACrosstalk) {
  constexpr double kOpen = 5.0, kDecided = 20.0;  // logarithm of the odds
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  const rig::Campaign world = worlds.Record(kSeed, {"probe-gain:object=probe_d:delta=0.05"});
  std::vector<recording::Recording> recordings = SweepsOf(world);
  const diagnosis::Campaign campaign = CampaignOf(worlds, recordings);
  EXPECT_LT(std::abs(ShownBy(campaign)), kOpen);

  auto runs = campaign.runs();
  const std::size_t recorded = runs.size();
  for (auto& possible : diagnosis::PossibleRuns(campaign, recordings)) {
    if (possible.text.starts_with("swap the cables of probe_d+probe_e at the amplifier")) {
      runs.push_back(std::move(possible.run));
    }
  }
  ASSERT_EQ(runs.size(), recorded + 1);
  const diagnosis::LinearRuns linear(campaign, runs,
                                     diagnosis::ValuesOf(diagnosis::Fit(campaign).result()));
  EXPECT_LT(ExpectedOf(linear, recorded), kOpen);
  EXPECT_GT(ExpectedOf(linear, recorded + 1), kDecided);

  recordings.push_back(Swapped(worlds, "0.05"));
  const diagnosis::Campaign then = CampaignOf(worlds, recordings);
  EXPECT_GT(ShownBy(then), kDecided);
  const auto score = diagnosis::ScoreAll(diagnosis::Fit(then), Rivals()).front();
  const auto keys = diagnosis::KeysOf(score);
  EXPECT_NEAR(keys.values[0], 0.05, 3.9 * keys.u[0] + 0.001) << "known to the gain of 0.05 %";
}

}  // namespace swapped_cables_test
}  // namespace abbe
