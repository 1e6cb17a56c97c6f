// A ball that is seated anew for each run: by 3 um in each direction, on a machine without faults.
#include <gtest/gtest.h>

#include "tests/hidden_effects/judgement.h"

namespace abbe {
namespace seated_ball_test {

constexpr double kSeat = 3e-6;  // m

TEST(SeatedBall, IsNoFaultWhereTheMachineFileStatesIt) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const auto stated = worlds.WithSeats(kSeat, kSeat);
  const auto world = stated.Record(81, {});
  EXPECT_EQ(DiagnosisOf(stated, 81, world).verdict, Verdict::kClean);
  // Without it the runs contradict each other.
  EXPECT_NE(DiagnosisOf(worlds.WithSeats(kSeat, 0.0), 81, world).verdict, Verdict::kClean);
}

}  // namespace seated_ball_test
}  // namespace abbe
