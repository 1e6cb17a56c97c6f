// A tolerance of zero takes no cause away.
#include <gtest/gtest.h>

#include "diagnosis/extended_run.h"

namespace abbe::diagnosis {
namespace zero_tolerance_test {

TEST(ZeroTolerance, LeavesTheCausesThatWidenIt) {
  simulation::Trace trace;
  trace.linkage.emplace();
  trace.linkage->angles = Eigen::MatrixXd::Zero(3, 4);
  const simulation::Scene scene{{&trace}, Eigen::Vector3d::Constant(0.1)};
  const auto block = [](const char* name) {
    estimation::ParameterBlock made(name, {"", 1.0}, {});
    made.entries.push_back({.name = "after_pivot_2", .held = true});
    made.entries.push_back({.name = "after_pivot_3", .prior_sd = 3e-6});
    return made;
  };
  std::vector<estimation::ParameterBlock> blocks{block("expansion"), block("length")};
  FreeForCauses(scene, blocks);
  const auto& expansion = blocks[0].entries;
  EXPECT_FALSE(expansion[0].held);
  EXPECT_GT(expansion[0].prior_sd, 0.0);
  EXPECT_LT(expansion[0].prior_sd, 1e-6);  // no more than a tenth of what a link can have: 10 ppm/K
  EXPECT_EQ(expansion[1].prior_sd, 3e-6);
  EXPECT_TRUE(blocks[1].entries[0].held);  // what no cause is about
}

}  // namespace zero_tolerance_test
}  // namespace abbe::diagnosis
