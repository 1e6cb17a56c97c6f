// A finding with every evidence that is not certain all the same.
#include "diagnosis/doubts.h"

#include <gtest/gtest.h>

#include "simulation/causes/registry.h"

namespace abbe::diagnosis {
namespace doubts_test {

Finding FindingOf(const char* cause, const char* object, const Eigen::VectorXd& coefficients,
                  double u, const Eigen::VectorXd& shape = {}) {
  const Eigen::Index count = coefficients.size();
  return {{{&simulation::CauseNamed(cause), simulation::Object(object), shape},
           coefficients,
           u * u * Eigen::MatrixXd::Identity(count, count)},
          1.0,
          {}};
}

Diagnosis With(Finding finding) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::kExplained;
  diagnosis.findings.push_back(std::move(finding));
  return diagnosis;
}

Diagnosis Doubted(Finding finding, const HeldOutGain& gain = {}, simulation::Scene scene = {}) {
  Diagnosis diagnosis = With(std::move(finding));
  AddDoubts(scene, diagnosis);
  AddDoubtsOfHeldOut(gain, diagnosis);
  return diagnosis;
}

const Eigen::VectorXd kWidth = Eigen::VectorXd::Constant(1, 5e-6);  // m

TEST(Doubts, AreNoneOfAFindingThatIsLargeAndHoldsElsewhere) {
  const HeldOutGain gain{.rows = 100, .before = 3.0, .after = 1.0, .without = {{3.0, 3.0}}};
  const Diagnosis diagnosis = Doubted(FindingOf("backlash", "X", kWidth, 0.1e-6), gain);
  EXPECT_TRUE(diagnosis.findings.front().doubts.empty());
  EXPECT_EQ(diagnosis.findings.front().probability, 1.0);
  EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
}

TEST(Doubts, TakeCertaintyFromASizeWithinItsU95) {
  const Diagnosis diagnosis = Doubted(FindingOf("backlash", "X", kWidth, 3e-6));
  ASSERT_EQ(diagnosis.findings.front().doubts.size(), 1u);
  EXPECT_LE(diagnosis.findings.front().probability, kDoubtful);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
}

TEST(Doubts, TakeCertaintyFromWhatMakesHeldOutRowsWorse) {
  const HeldOutGain gain{.rows = 100, .before = 247.0, .after = 1331.0, .without = {{2.0, 247.0}}};
  EXPECT_EQ(Doubted(FindingOf("backlash", "X", kWidth, 0.1e-6), gain).verdict, Verdict::kAmbiguous);
}

// 0.98 of a reading goes from one probe into the other: no cable does that.
TEST(Doubts, TakeCertaintyFromASizeBeyondItsBounds) {
  const Finding finding =
      FindingOf("probe-crosstalk", "probe_a+probe_b", Eigen::VectorXd::Constant(1, 0.98), 1e-3);
  ASSERT_EQ(Doubted(finding).findings.front().doubts.size(), 1u);
}

// What shakes a head stands out in all of its probes.
TEST(Doubts, TakeCertaintyFromOutliersOfSeveralChannels) {
  const Eigen::VectorXd count = Eigen::VectorXd::Constant(1, 7.0);
  Diagnosis diagnosis = With(FindingOf("outliers", "probe_a", count, 0.0));
  AddDoubts({}, diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
  diagnosis.findings.push_back(FindingOf("outliers", "pivot_1", count, 0.0));
  AddDoubts({}, diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kExplained);
  diagnosis.findings.push_back(FindingOf("outliers", "probe_d", count, 0.0));
  AddDoubts({}, diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
}

// Targets 10 mm apart tell a pitch of 2.96 mm from one of 4.2 mm by no reading.
TEST(Doubts, TakeCertaintyFromAPeriodBelowTwoTargets) {
  simulation::Trace trace;
  trace.axes = Eigen::Matrix3Xd::Zero(3, 20);
  trace.axes.row(0) = Eigen::RowVectorXd::LinSpaced(20, 0.0, 0.19);
  simulation::Scene scene;
  scene.traces = {&trace};
  scene.travel.setConstant(0.2);
  const Eigen::VectorXd wave = Eigen::Vector2d(1e-6, 0.0);
  const auto with_pitch = [&](double pitch) {
    return Doubted(
        FindingOf("leadscrew-cyclic", "X", wave, 1e-8, Eigen::VectorXd::Constant(1, pitch)), {},
        scene);
  };
  EXPECT_EQ(with_pitch(2.96e-3).verdict, Verdict::kAmbiguous);
  EXPECT_EQ(with_pitch(25e-3).verdict, Verdict::kExplained);
}

// 11.76 readings a second show a vibration of 4.27 Hz like one of 54.55 Hz.
TEST(Doubts, TakeCertaintyFromAWaveThatIsOneOfSeveral) {
  const Eigen::VectorXd wave = Eigen::Vector2d(1e-6, 0.0);
  const auto at = [&](double frequency) {
    return FindingOf("vibration", "X", wave, 1e-8, Eigen::VectorXd::Constant(1, frequency));
  };
  EXPECT_EQ(Doubted(at(4.27)).verdict, Verdict::kExplained);
  Finding finding = at(4.27);
  finding.score.one_of = {at(4.27).score, at(54.55).score};
  const Diagnosis diagnosis = Doubted(finding);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_LE(diagnosis.findings.front().probability, kDoubtful);
  // Four readings in each wave of the faster one.
  EXPECT_NE(diagnosis.findings.front().doubts.front().find("every 4.6 ms"), std::string::npos);
}

}  // namespace doubts_test
}  // namespace abbe::diagnosis
