// The run that is proposed, made on the rig: it tells the rivals apart.
#include "diagnosis/next_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/expected_odds.h"
#include "diagnosis/linear_runs.h"
#include "diagnosis/run_catalogue.h"
#include "simulation/causes/registry.h"
#include "simulation/planned_paths.h"
#include "tests/hidden_effects/hidden_world.h"

namespace abbe::diagnosis {
namespace next_run_test {

constexpr const char* kCircle = "circle_XY_20mm_600";

// The sweeps of a campaign, and its runs with one of these in their names.
std::vector<recording::Recording> SweepsAnd(const rig::Campaign& world,
                                            const std::vector<std::string>& names) {
  std::vector<recording::Recording> chosen;
  for (const auto& recording : world.recordings) {
    const bool wanted = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return recording.name.find(name) != std::string::npos;
    });
    if (wanted || recording.Kind() == "sweep") chosen.push_back(recording);
  }
  return chosen;
}

Campaign CampaignOf(const HiddenWorlds& worlds,
                    const std::vector<recording::Recording>& recordings) {
  Campaign campaign(worlds.setup());
  for (const auto& recording : recordings) campaign.Add(recording);
  return campaign;
}

struct Proposal {
  const char* hidden;
  const char* right;     // what it is
  const char* rival;     // what it could be too, by one circle at one feed
  const char* proposed;  // part of the text
  const char* run;       // of a standard campaign: what was proposed, or as good
};

class Proposals : public testing::TestWithParam<Proposal> {};

TEST_P(Proposals, TellTheRivalsApartOnTheRig) {
  const Proposal& expected = GetParam();
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const auto world = worlds.Record(4, {expected.hidden});
  const auto few = SweepsAnd(world, {kCircle});
  const Campaign campaign = CampaignOf(worlds, few);
  Diagnosis diagnosis = Diagnose(campaign);
  ASSERT_EQ(diagnosis.findings.size(), 1U);
  AddNextRuns(campaign, few, diagnosis);
  const Finding& finding = diagnosis.findings.front();
  std::vector<std::string> names{finding.score.candidate.Name()};
  for (const Rival& rival : finding.rivals) names.push_back(rival.candidate.Name());
  EXPECT_THAT(names, testing::IsSupersetOf({expected.right, expected.rival}));
  ASSERT_TRUE(finding.next_run);
  EXPECT_THAT(finding.next_run->text, testing::HasSubstr(expected.proposed));
  EXPECT_GE(finding.next_run->expected_probability, kCertain);

  const Diagnosis then = Diagnose(CampaignOf(worlds, SweepsAnd(world, {kCircle, expected.run})));
  EXPECT_EQ(then.verdict, Verdict::kExplained);
  ASSERT_EQ(then.findings.size(), 1U);
  EXPECT_EQ(then.findings.front().score.candidate.Name(), expected.right);
}

INSTANTIATE_TEST_SUITE_P(
    OfOneCircle, Proposals,
    testing::Values(
        // At 10 mm/s these are 5 um, as a drag would be; and a drag is more usual.
        Proposal{"clock-skew:object=linkage:delay_ms=0.5", "clock-skew:linkage", "cap-friction:cap",
                 "at 120 mm/min instead of 600", "circle_XY_20mm_120"},
        // A mismatch of X and Z is one of X alone where Z stands.
        Proposal{"servo-lag:object=X:delay_ms=0.1", "servo-lag:X", "servo-lag-mismatch:XZ",
                 "record a circle in ZX", "circle_ZX_20mm_600"}),
    [](const auto& each) { return each.index == 0 ? "AnotherFeed" : "AnotherPlane"; });

// What the readings of the rig say for a late clock against a drag is what was to be expected.
TEST(ExpectedEvidence, IsWhatTheRigThenShows) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const auto world = worlds.Record(9, {"clock-skew:object=linkage:delay_ms=0.06"});
  const Campaign campaign = CampaignOf(worlds, SweepsAnd(world, {kCircle, "circle_XY_20mm_120"}));
  const std::vector<Candidate> rivals{{&simulation::CauseNamed("clock-skew"), "linkage", {}},
                                      {&simulation::CauseNamed("cap-friction"), "cap", {}}};
  const Fit fit(campaign);
  const auto scores = ScoreAll(fit, rivals);
  const double shown = scores[0].log_evidence - scores[1].log_evidence;

  const LinearRuns linear(campaign, campaign.runs(), ValuesOf(fit.result()));
  std::vector<RunSums> sums;
  for (std::size_t run = 0; run < linear.count(); ++run) {
    sums.push_back(linear.SumsOf(linear.At(run), rivals));
  }
  const auto evidence = ExpectedEvidence(linear.Information(PointersTo(sums)),
                                         {{rivals[0], Eigen::VectorXd::Constant(1, 0.06e-3), 0.5},
                                          {rivals[1], Eigen::VectorXd::Zero(1), 0.5}},
                                         0);
  const double expected = evidence[0] - evidence[1];
  EXPECT_GT(expected, 100.0);
  // The logarithm of the odds between two known columns has twice its mean as variance.
  EXPECT_NEAR(shown, expected, 3.9 * std::sqrt(2.0 * expected));
}

TEST(RunCatalogue, OffersWhatTheRunsAtHandAllow) {
  const HiddenWorlds worlds(rig::CampaignKind::kStandard);
  const auto world = worlds.Record(4, {});
  const auto texts = [&](const std::vector<recording::Recording>& recordings) {
    std::vector<std::string> all;
    for (const auto& run : PossibleRuns(CampaignOf(worlds, recordings), recordings)) {
      EXPECT_GT(run.seconds, 0.0) << run.text;
      all.push_back(run.text);
    }
    return all;
  };
  const auto elbow = testing::HasSubstr("elbow down");
  const auto anew = testing::HasSubstr("mount the target anew");
  const auto of_both = texts(SweepsAnd(world, {kCircle}));
  EXPECT_THAT(of_both, testing::Contains(elbow));
  EXPECT_THAT(of_both, testing::Contains(anew).Times(3));
  const std::vector<recording::Recording> sweep{world.recordings.front()};
  EXPECT_THAT(texts(sweep), testing::Not(testing::Contains(elbow)));
  EXPECT_THAT(texts(sweep), testing::Contains(testing::HasSubstr("gap steps")).Times(1));
}

TEST(PlannedPaths, ACircleKeepsItsRadiusAndItsFeed) {
  const auto circle = simulation::CirclePath(
      {.plane = "YZ", .centre = {1e-3, 2e-3, 3e-3}, .radius = 5e-3, .feed = 2e-3, .rows = 90},
      {"mill", 0.0, {}});
  const auto time = circle.At("time_s"), x = circle.At("x_mm"), y = circle.At("y_mm"),
             z = circle.At("z_mm");
  ASSERT_EQ(circle.rows(), 180U);
  for (std::size_t row = 0; row < circle.rows(); ++row) {
    EXPECT_DOUBLE_EQ(x[row], 1.0);
    EXPECT_NEAR(std::hypot(y[row] - 2.0, z[row] - 3.0), 5.0, 1e-12);
    if (row == 0 || row == 90) continue;
    const double chord = std::hypot(y[row] - y[row - 1], z[row] - z[row - 1]);
    const double arc = 10.0 * std::asin(chord / 10.0);
    EXPECT_NEAR(arc / (time[row] - time[row - 1]), 2.0, 1e-9);
  }
}

}  // namespace next_run_test
}  // namespace abbe::diagnosis
