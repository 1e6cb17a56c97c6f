// Holes that were read wrong, among those of plates of the virtual rig, which shares no code with
// the simulation.
#include "fusion/wrong_holes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "random/counter_random.h"
#include "recording/recording.h"
#include "rig/record_plate.h"
#include "tests/fusion/rig_campaign.h"

namespace abbe::fusion {
namespace wrong_holes_test {

using Named = std::set<std::pair<std::size_t, int>>;  // set-up, hole

constexpr std::uint64_t kSeeds = 8;
constexpr int kHoles = 49;  // of a set-up

Named NamesOf(const Campaign& campaign, const recording::Recording& recording, bool anywhere) {
  Named names;
  for (const WrongHole& each : FindWrongHoles(campaign.machine, simulation::ReadPlate(recording))) {
    EXPECT_EQ(each.anywhere, anywhere);
    names.emplace(each.setup, each.hole);
  }
  return names;
}

// For each of some machines, with the recording of a plate on it.
template <typename Check>
void OnMachines(const Check& check) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const Campaign campaign(CampaignMachine(), seed);
    check(campaign, rig::RecordPlate(campaign.rig.world(), {}), seed);
  }
}

// Moves the axes at the hole of a set-up.
void Shift(recording::Recording& recording, std::size_t setup, int hole, double mm) {
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (recording.At("setup")[row] != setup + 1.0 || recording.At("hole")[row] != hole) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) recording.columns[axis].values[row] += mm;
  }
}

TEST(WrongHoles, AreNamedAndNoOthers) {
  OnMachines([](const Campaign& campaign, recording::Recording recording, std::uint64_t seed) {
    EXPECT_EQ(NamesOf(campaign, recording, false), Named{});
    const random::CounterRandom random(seed, 0xB01E);
    Named wrong;
    for (std::uint64_t i = 0; wrong.size() < 4; ++i) {
      wrong.emplace(i % 2 == 0 ? 0 : 2, 1 + static_cast<int>(kHoles * random.Uniform(i)));
    }
    for (const auto& [setup, hole] : wrong) Shift(recording, setup, hole, 0.02);
    EXPECT_EQ(NamesOf(campaign, recording, false), wrong);
  });
}

TEST(WrongHoles, AMovedBushIsWrongInAllSetups) {
  OnMachines([](const Campaign& campaign, recording::Recording recording, std::uint64_t seed) {
    const int hole = 1 + static_cast<int>(5 * seed);
    Named wrong;
    // The certificate is off, not the hole: the same.
    for (recording::Column& column : recording.columns) {
      if (column.name != "plate_x_mm") continue;
      for (std::size_t row = 0; row < recording.rows(); ++row) {
        if (recording.At("hole")[row] == hole) column.values[row] += 0.02;
      }
    }
    for (std::size_t setup = 0; setup < 5; ++setup) wrong.emplace(setup, hole);
    EXPECT_EQ(NamesOf(campaign, recording, true), wrong);
  });
}

// A machine that jumps by 8 um in the middle of X does it in all rows of holes.
TEST(WrongHoles, AreNotWhatTheMachineDoes) {
  OnMachines([](const Campaign& campaign, recording::Recording recording, std::uint64_t) {
    const std::vector<double> x(recording.At("x_mm").begin(), recording.At("x_mm").end());
    for (std::size_t row = 0; row < recording.rows(); ++row) {
      if (x[row] > 30.0) recording.columns[1].values[row] += 0.008;
    }
    EXPECT_EQ(NamesOf(campaign, recording, false), Named{});
  });
}

TEST(WrongHoles, AreLeftOut) {
  const Campaign campaign(CampaignMachine(), 1);
  const auto setups = simulation::ReadPlate(rig::RecordPlate(campaign.rig.world(), {}));
  const auto rest = WithoutHoles(setups, {{1, 3, setups[1].holes[3], {0.0, 0.0}, 9.0, false}});
  EXPECT_EQ(rest[0].points.count(), kHoles);
  ASSERT_EQ(rest[1].points.count(), kHoles - 1);
  EXPECT_EQ(rest[1].holes[3], setups[1].holes[4]);
  EXPECT_EQ(rest[1].points.axes.col(3), setups[1].points.axes.col(4));
  EXPECT_EQ(rest[1].certificate.col(3), setups[1].certificate.col(4));
}

}  // namespace wrong_holes_test
}  // namespace abbe::fusion
