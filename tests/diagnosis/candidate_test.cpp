// What is plausible on a coarser machine.
#include "diagnosis/candidate.h"

#include <gtest/gtest.h>

namespace abbe::diagnosis {
namespace candidate_test {

double CoarsenessAt(double positioning) {
  machine::Population population{};
  population.positioning = positioning;
  return CoarsenessOf(population);
}

TEST(Coarseness, IsOneForMachinesOfTwoMicrometresAndFinerOnes) {
  EXPECT_DOUBLE_EQ(CoarsenessAt(0.5e-6), 1.0);
  EXPECT_DOUBLE_EQ(CoarsenessAt(2e-6), 1.0);
  EXPECT_DOUBLE_EQ(CoarsenessAt(40e-6), 20.0);
}

TEST(Coarseness, ScalesTheLengthsOfTheAxesOnly) {
  simulation::Trace sweep;
  sweep.gap = Eigen::MatrixXd::Ones(5, 2);
  const simulation::Scene scene{{&sweep}, Eigen::Vector3d::Constant(0.1)};
  int lengths = 0;
  for (const Candidate& each : AllCandidates(scene, 20.0)) {
    if (each.cause->drawn) continue;  // as large as its shape says
    const std::string& id = each.cause->id;
    const bool length = id == "backlash" || id == "leadscrew-cyclic" || id == "reversal-spike" ||
                        id == "vibration" || id == "warm-up-drift";
    const double factor = length && !each.object.starts_with("probe_") ? 20.0 : 1.0;
    EXPECT_EQ(each.Plausible(), factor * each.cause->plausible) << each.Name();
    lengths += factor > 1.0 ? 1 : 0;
  }
  EXPECT_GT(lengths, 4);
}

}  // namespace candidate_test
}  // namespace abbe::diagnosis
