// A gain that plain sweeps cannot tell from a crosstalk: two cables exchanged are proposed, and
// tell, with the gain of the channel acting on the other probe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "diagnosis/next_run.h"
#include "rig/record_sweep.h"
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

TEST(SwappedCables, TellAGainFromACrosstalk) {
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  const rig::Campaign world = worlds.Record(kSeed, {"probe-gain:object=probe_d:delta=0.05"});
  std::vector<recording::Recording> recordings = SweepsOf(world);
  const diagnosis::Campaign campaign = CampaignOf(worlds, recordings);
  Diagnosis diagnosis = diagnosis::Diagnose(campaign);
  diagnosis::AddNextRuns(campaign, recordings, diagnosis);
  Print(kSeed, world, diagnosis);
  ASSERT_EQ(diagnosis.findings.size(), 1u);
  const Finding& finding = diagnosis.findings.front();
  std::vector<std::string> names{finding.score.candidate.Name()};
  for (const auto& rival : finding.rivals) names.push_back(rival.candidate.Name());
  for (const auto& name : names) fmt::print("{}\n", name);
  ASSERT_TRUE(finding.next_run);
  fmt::print("{} {}\n", finding.next_run->text, finding.next_run->expected_probability);

  recordings.push_back(Swapped(worlds, "0.05"));
  const Diagnosis then = DiagnosisOf(worlds, kSeed, {recordings, world.hidden});
  ASSERT_EQ(then.findings.size(), 1u);
  EXPECT_EQ(then.findings.front().score.candidate.Name(), "probe-gain:probe_d");
  EXPECT_EQ(then.verdict, Verdict::kExplained);
  const auto keys = KeysOf(then.findings.front().score);
  EXPECT_NEAR(keys.values[0], 0.05, 3.9 * keys.u[0]);
}

}  // namespace swapped_cables_test
}  // namespace abbe
