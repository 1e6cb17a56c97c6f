// What is plausible on a coarser machine.
#include "diagnosis/candidate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "diagnosis/standing_pairs.h"

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
  sweep.head.emplace().gap = Eigen::MatrixXd::Ones(5, 2);
  const simulation::Scene scene{{&sweep}, Eigen::Vector3d::Constant(0.1)};
  int lengths = 0;
  for (const Candidate& each : AllCandidates(scene, 20.0)) {
    if (each.cause->IsRandomField()) continue;  // as large as its shape says
    const std::string& id = each.cause->id;
    const bool length = id == "backlash" || id == "varying-backlash" || id == "leadscrew-cyclic" ||
                        id == "reversal-spike" || id == "vibration" || id == "warm-up-drift";
    const double factor = length && !each.object.name().starts_with("probe_") ? 20.0 : 1.0;
    EXPECT_EQ(each.Plausible(), factor * each.cause->plausible) << each.Name();
    lengths += factor > 1.0 ? 1 : 0;
  }
  EXPECT_GT(lengths, 4);
}

// A run that moves some axes and leaves the others at 30 mm, with the jitter of a drive.
simulation::Trace TraceThatMoves(const std::string& axes) {
  simulation::Trace trace;
  trace.axes = Eigen::Matrix3Xd::Constant(3, 50, 0.03);
  for (Eigen::Index i = 0; i < trace.axes.cols(); ++i) {
    for (const char axis : std::string("XYZ")) {
      trace.axes(axis - 'X', i) +=
          axes.find(axis) == std::string::npos ? 1e-8 * double(i % 2) : 1e-3 * double(i);
    }
  }
  return trace;
}

std::set<std::string> ObjectsOf(const std::string& cause, const simulation::Scene& scene) {
  std::set<std::string> objects;
  for (const Candidate& each : AllCandidates(scene)) {
    if (each.cause->id == cause) objects.insert(each.object.name());
  }
  return objects;
}

// Where X moves and another axis never does, the lag of X is all that shows: under one name.
TEST(AllCandidates, HasPairsOnlyOfAxesThatMove) {
  const auto plane = TraceThatMoves("XZ");
  const simulation::Scene scene{{&plane}, Eigen::Vector3d::Constant(0.06)};
  for (const char* cause : {"servo-lag-mismatch", "squareness", "load-coupling"}) {
    EXPECT_THAT(ObjectsOf(cause, scene), testing::ElementsAre("XZ")) << cause;
  }
  EXPECT_THAT(ObjectsOf("servo-lag", scene), testing::ElementsAre("X", "Y", "Z"));
  EXPECT_THAT(StandingPairs(scene),
              testing::UnorderedElementsAre("servo-lag-mismatch:XY", "servo-lag-mismatch:YZ",
                                            "squareness:XY", "squareness:YZ", "load-coupling:XY",
                                            "load-coupling:YZ"));
}

// One axis after the other: together they moved all three.
TEST(AllCandidates, CountsTheMotionOfAllRuns) {
  const auto x = TraceThatMoves("X"), y = TraceThatMoves("Y"), z = TraceThatMoves("Z");
  const simulation::Scene scene{{&x, &y, &z}, Eigen::Vector3d::Constant(0.06)};
  EXPECT_THAT(ObjectsOf("squareness", scene), testing::ElementsAre("XY", "XZ", "YZ"));
  EXPECT_THAT(StandingPairs(scene), testing::IsEmpty());
}

TEST(AllCandidates, KnowsNoAxisThatTheMachineLacks) {
  auto x = TraceThatMoves("X");
  x.axes.bottomRows<2>().setZero();
  const simulation::Scene scene{{&x}, {0.06, 0.0, 0.0}};
  for (const Candidate& each : AllCandidates(scene)) {
    const std::string axes =
        each.object.name().substr(0, each.object.name().find_first_not_of("XYZ"));
    EXPECT_EQ(axes.find_first_of("YZ"), std::string::npos) << each.Name();
  }
  EXPECT_THAT(ObjectsOf("backlash", scene), testing::ElementsAre("X"));
  EXPECT_THAT(StandingPairs(scene), testing::IsEmpty());
}

// A cause that stood in the list twice could be its own rival.
TEST(AllCandidates, NamesEachCauseOnce) {
  auto sweep = TraceThatMoves("XYZ"), other = sweep;
  sweep.head.emplace().gap = Eigen::MatrixXd::Ones(5, 50);
  sweep.sensors = other.sensors = {"temp_table_c", "temp_air_c"};
  const simulation::Scene scene{{&sweep, &other}, Eigen::Vector3d::Constant(0.06)};
  std::set<std::string> names;
  std::string last;
  for (const Candidate& each : AllCandidates(scene)) {
    if (each.Name() == last) continue;  // another shape of it
    last = each.Name();
    EXPECT_TRUE(names.insert(last).second) << last;
  }
  EXPECT_GT(names.size(), 50U);
}

}  // namespace candidate_test
}  // namespace abbe::diagnosis
