// What a plan promises: closed forms on circles, and what the rig then shows.
#include "diagnosis/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnosis/diagnose.h"
#include "diagnosis/linear_runs.h"
#include "failure/failure.h"
#include "random/counter_random.h"
#include "simulation/causes/registry.h"
#include "simulation/kinds.h"
#include "tests/diagnosis/planned_circles.h"
#include "tests/hidden_effects/hidden_world.h"

namespace abbe::diagnosis {
namespace plan_test {

using Eigen::MatrixXd;

Campaign Circles(const std::vector<double>& feeds) {
  const simulation::Instruments setup = DemoInstruments();
  Campaign campaign(setup);
  for (const double feed : feeds) campaign.Add(Planned(CircleAt(feed), setup));
  return campaign;
}

Plan PlanOf(const Campaign& campaign) {
  const random::CounterRandom random(3, 0);
  std::uint64_t index = 0;
  return PlanOf(campaign, [&] { return random.Normal(index++); });
}

const PlannedCause& Find(const Plan& plan, const std::string& name) {
  return *std::find_if(plan.causes.begin(), plan.causes.end(),
                       [&](const PlannedCause& cause) { return cause.candidate.Name() == name; });
}

const Candidate kDrag{&simulation::CauseNamed("cap-friction"), "cap", {}};
const Candidate kLate{&simulation::CauseNamed("clock-skew"), "linkage", {}};

// Cosine of the columns of both in all runs, before anything is projected out.
double CosineOf(const Campaign& campaign) {
  const LinearRuns linear(campaign, campaign.runs(), {});
  MatrixXd sum = MatrixXd::Zero(2, 2);
  for (std::size_t run = 0; run < linear.count(); ++run) {
    sum += linear.SumsOf(linear.At(run), {kDrag, kLate}).C_C;
  }
  return sum(0, 1) / std::sqrt(sum(0, 0) * sum(1, 1));
}

TEST(Plan, ADragInTheCapAndALateClockAreOneOnACircleAtOneFeed) {
  const Campaign campaign = Circles({600.0});
  // The ball lags by d in the one case, by feed times delay in the other, along the same tangent.
  EXPECT_NEAR(CosineOf(campaign), 1.0, 1e-4);
  const Plan plan = PlanOf(campaign);
  const auto alike = std::find_if(plan.alike.begin(), plan.alike.end(), [&](const Alike& each) {
    return plan.causes[each.first].candidate.Name() == kDrag.Name() &&
           plan.causes[each.second].candidate.Name() == kLate.Name();
  });
  ASSERT_NE(alike, plan.alike.end());
  EXPECT_GT(alike->cosine, 0.999);
}

TEST(Plan, TwoFeedsTellADragFromALateClock) {
  const Campaign campaign = Circles({600.0, 120.0});
  // Per row 1 and the feed v: (v1 + v2) / sqrt(2 (v1^2 + v2^2)), v1 = 5 v2.
  EXPECT_NEAR(CosineOf(campaign), 6.0 / std::sqrt(2.0 * 26.0), 1e-4);
  const Plan plan = PlanOf(campaign);
  for (const Alike& each : plan.alike) {
    EXPECT_FALSE(plan.causes[each.first].candidate.Name() == kDrag.Name() &&
                 plan.causes[each.second].candidate.Name() == kLate.Name());
  }
}

TEST(Plan, LikenessIsTheCosineOfTwoColumns) {
  // Directions that do not stand out do not count.
  MatrixXd S(2, 2);
  S << 100.0, 30.0, 30.0, 25.0;
  EXPECT_NEAR(Likeness(S, 1), 30.0 / 50.0, 1e-12);
  S << 100.0, 0.3, 0.3, 0.25;
  EXPECT_EQ(Likeness(S, 1), 0.0);
  // Two planes with one direction in common: sqrt((1 + 0) / 2).
  MatrixXd planes = 9.0 * MatrixXd::Identity(4, 4);
  planes(0, 2) = planes(2, 0) = 9.0;
  EXPECT_NEAR(Likeness(planes, 2), std::sqrt(0.5), 1e-12);
}

TEST(Plan, ACircleKnowsNoTemperatureAndNoProbe) {
  const Plan plan = PlanOf(Circles({600.0}));
  for (const PlannedCause& cause : plan.causes) {
    EXPECT_FALSE(cause.candidate.object.name().starts_with("probe_")) << cause.candidate.Name();
    EXPECT_NE(cause.candidate.cause->id, "thermal-growth");
  }
}

TEST(Plan, SizesFollowTheKeys) {
  const Plan plan = PlanOf(Circles({600.0}));
  const PlannedCause& play = Find(plan, "backlash:X");
  ASSERT_TRUE(play.seen());
  const auto [plausible, seen] = play.sizes();
  EXPECT_DOUBLE_EQ(seen[0] / plausible[0], kShowable / play.visible);
  const PlannedCause& wave = Find(plan, "leadscrew-cyclic:X");
  EXPECT_TRUE(std::isnan(wave.sizes().seen[0]));  // its pitch
  EXPECT_GT(wave.sizes().seen[1], 0.0);
}

// The rig records what was planned, with a cause in it: its size is found as well as was promised.
struct Promise {
  const char* name;
  const char* hidden;
  const char* key;
  double size;  // SI
};

class Promises : public testing::TestWithParam<Promise> {};

TEST_P(Promises, AreKeptByTheRig) {
  const Promise& promise = GetParam();
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  const auto world = worlds.Record(11, {promise.hidden});
  const Campaign recorded = worlds.Recordings(world);
  Campaign paths(recorded.instruments());
  for (const auto& recording : world.recordings) {
    paths.Add(Planned(recording, recorded.instruments()));
  }
  const Plan plan = PlanOf(paths);
  const PlannedCause& planned = Find(plan, promise.name);
  const double promised_u = std::abs(planned.sizes().seen[0]) / kShowable;
  ASSERT_GT(promise.size, kShowable * promised_u);
  const Score found =
      ScoreAll(Fit(recorded), {{planned.candidate.cause, planned.candidate.object, {}}}).front();
  const Keys keys = KeysOf(found);
  // 3.9: 99.99 % of normal errors. The other machine and the noise that is taken from the readings
  // change the uncertainty.
  EXPECT_NEAR(keys.values[0], promise.size, 3.9 * promised_u);
  EXPECT_NEAR(keys.u[0] / promised_u, 1.0, 0.15);
}

INSTANTIATE_TEST_SUITE_P(
    OfAMinimalCampaign, Promises,
    testing::Values(Promise{"backlash:X", "backlash:object=X:width_um=0.5", "width_um", 0.5e-6},
                    Promise{"cap-friction:cap", "cap-friction:object=cap:displacement_um=1",
                            "displacement_um", 1e-6},
                    Promise{"servo-lag-mismatch:XY", "servo-lag-mismatch:object=XY:delay_ms=0.1",
                            "delay_ms", 0.1e-3}),
    [](const auto& each) { return std::string(each.param.key); });

// What stands out of the rig's readings is what was promised of their paths. Gaps that change as
// the machine that is measured makes them change: these causes are left to their own machine.
TEST(Plan, SeesAsMuchAsTheDiagnosisOfTheRigThenDoes) {
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  const auto world = worlds.Record(12, {});
  const Campaign recorded = worlds.Recordings(world);
  Campaign paths(recorded.instruments());
  for (const auto& recording : world.recordings) {
    paths.Add(Planned(recording, recorded.instruments()));
  }
  std::map<std::string, double> visible;
  for (const Score& score : ScoreAll(Fit(recorded), AllCandidates(recorded.scene()))) {
    double& most = visible[score.candidate.Name()];
    most = std::max(most, score.visible);
  }
  const Plan plan = PlanOf(paths);
  EXPECT_EQ(plan.causes.size(), visible.size());
  for (const PlannedCause& cause : plan.causes) {
    const std::string& id = cause.candidate.cause->id;
    if (id.starts_with("probe-") || id.starts_with("channel-")) continue;
    const double then = visible.at(cause.candidate.Name());
    // One standard deviation: both are far from being seen.
    EXPECT_NEAR(cause.visible, then, 0.1 * then + 1.0) << cause.candidate.Name();
  }
}

TEST(Plan, WantsALinkageInTheMachineFile) {
  auto setup = DemoInstruments();
  setup.linkage.reset();
  EXPECT_THROW(Planned(CircleAt(600.0), setup), InputError);
}

}  // namespace plan_test
}  // namespace abbe::diagnosis
