// Functions of one stage projected together must tell what the same disturbances tell, also where
// the noise of the rows has a memory.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "diagnosis/fit.h"
#include "tests/hidden_effects/judgement.h"

namespace abbe {
namespace projection_test {

using Eigen::Index;

Eigen::RowVectorXd Alternating(Index rows) {
  Eigen::RowVectorXd values(rows);
  for (Index row = 0; row < rows; ++row) values[row] = row % 2 == 0 ? 1e-6 : -1e-6;
  return values;
}

// What each run says of a function, in each stage that it feels; returns how many stages.
int CompareStages(const diagnosis::Fit& fit) {
  int compared = 0;
  for (std::size_t run = 0; run < fit.runs(); ++run) {
    const simulation::Trace& trace = fit.TraceOf(run);
    for (Index stage = 0; stage < simulation::kStages; ++stage) {
      const auto weights = fit.ScoresOf(run, stage).weights;
      if (weights.size() == 0 || !(weights.maxCoeff() > 0.0)) continue;
      const Eigen::RowVectorXd function = Alternating(weights.size());
      std::vector<Eigen::MatrixXd> functions(fit.runs());
      functions[run] = function;
      const auto of_function = fit.ProjectInStage(stage, functions, {1}).front();
      const auto disturber = [&](const simulation::Trace& of_run) {
        return std::vector{&of_run == &trace ? simulation::InStage(of_run, stage, function)
                                             : simulation::Disturbance(of_run.rows())};
      };
      const auto of_disturbance = fit.Project(disturber, {1}).front();
      const double information = of_disturbance.information(0, 0);
      EXPECT_GT(information, 0.0) << run << ' ' << stage;
      EXPECT_NEAR(of_function.information(0, 0) / information, 1.0, 1e-9) << run << ' ' << stage;
      EXPECT_NEAR(of_function.score[0], of_disturbance.score[0], 1e-9 * std::sqrt(information));
      ++compared;
    }
  }
  return compared;
}

TEST(Projection, TellsTheSameOfFunctionsAndOfDisturbances) {
  const HiddenWorlds worlds(rig::CampaignKind::kMinimal);
  diagnosis::Campaign campaign = worlds.Recordings(worlds.Record(74, {}));
  EXPECT_GT(CompareStages(diagnosis::Fit(campaign)), 0);
  for (std::size_t run = 0; run < campaign.runs().size(); ++run) {
    campaign.SetMemory(run, {.white = 1.0, .slow = 2.0, .time = 1.0});
  }
  EXPECT_GT(CompareStages(diagnosis::Fit(campaign)), 0);
}

}  // namespace projection_test
}  // namespace abbe
