// Holding out half of a sweep in which only that half vibrates.
#include "diagnosis/hold_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "simulation/kinds.h"
#include "tests/hidden_effects/judgement.h"

namespace abbe {
namespace hold_out_test {

// m: while the second, fourth, ... pass is swept, 4.1 Hz.
void Vibrate(double amplitude, recording::Recording& sweep) {
  const auto time = *sweep.Find("time_s"), pass = *sweep.Find("pass");
  for (auto& column : sweep.columns) {
    if (!column.name.starts_with("probe_")) continue;
    for (std::size_t row = 0; row < column.values.size(); ++row) {
      if (std::lround(pass[row]) % 2 != 0) continue;
      column.values[row] += 1e6 * amplitude * std::sin(2.0 * std::numbers::pi * 4.1 * time[row]);
    }
  }
}

TEST(HoldOut, JudgesTheStationsWhereOnlyTheHeldOutPassesVibrate) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  rig::Campaign world = worlds.Record(73, {});
  for (auto& recording : world.recordings) {
    if (recording.Kind() == "sweep") Vibrate(0.3e-6, recording);
  }
  const diagnosis::Campaign campaign = worlds.Recordings(world);
  diagnosis::Campaign held = campaign.WithoutRuns();
  const auto sweep = std::ranges::find_if(world.recordings,
                                          [](const auto& each) { return each.Kind() == "sweep"; });
  const simulation::RunKind& kind = simulation::KindOf(*sweep);
  held.Add(kind.Part(*sweep, kind.HeldOut(*sweep)));
  ASSERT_EQ(held.runs().back().simulated.name, sweep->name + " (readings in stays)");
  const auto gain = diagnosis::HoldOut(campaign, world.recordings, {});
  EXPECT_GT(gain.rows, 0);
  EXPECT_GT(gain.before, 0.5);
  EXPECT_LT(gain.before, 5.0);
}

}  // namespace hold_out_test
}  // namespace abbe
