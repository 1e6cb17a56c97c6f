// The form of the target as numbers of places on its faces, against the correlation that the
// machine file states, between readings of one recording and of two.
#include "simulation/sweep/form_of_target.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

namespace abbe::simulation {
namespace form_of_target_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kForm = 25e-9, kLength = 15e-3, kArm = 10e-3;
constexpr Index kStations = 9;
// Humps are 0.8 lengths apart: sums of their products are constant within r = 2 exp(-(pi / 0.8)^2 /
// 2) by Poisson's formula, and divided by such sums of squares. Two spots 0.8 lengths apart, where
// both are off, correlate by exp(-0.8^2 / 2) to twice r of it; a third for the humps that are too
// far away to be there.
const double kOff = 1.33 * 2.0 * std::exp(-0.32) * 2.0 * std::exp(-std::pow(M_PI / 0.8, 2) / 2.0);

SweepInstrument Instrument() {
  SweepInstrument instrument{};
  instrument.head.layout = probes::NominalLayout(kArm);
  for (auto& axis : instrument.head.axes) axis.R_MH = Eigen::Matrix3d::Identity();
  instrument.target.form = kForm;
  instrument.target.form_length = kLength;
  return instrument;
}

SweepRun RunOver(double first, double last, const SweepMounting& mounted = {}) {
  SweepRun run;
  run.axis = 'X';
  run.mounted = mounted;
  run.position = VectorXd::LinSpaced(kStations, first, last);
  return run;
}

FormOfTarget FormIn(const SweepRun& run, const SweepInstrument& instrument = Instrument()) {
  return FormOfTargetIn(machine::Chain::Parse("[w b X Y Z t]"), instrument, run);
}

// The readings of one run with those of another, over the variance of the form.
MatrixXd Correlation(const FormOfTarget& one, const FormOfTarget& other) {
  std::map<std::string, Index> numbers;
  for (std::size_t i = 0; i < other.blocks.size(); ++i) {
    numbers.emplace(other.blocks[i].FullName(0), static_cast<Index>(i));
  }
  MatrixXd sum = MatrixXd::Zero(one.columns.rows(), other.columns.rows());
  for (std::size_t i = 0; i < one.blocks.size(); ++i) {
    const auto same = numbers.find(one.blocks[i].FullName(0));
    if (same == numbers.end()) continue;
    const double times = one.blocks[i].entries[0].prior_sd / kForm;
    sum += times * times * one.columns.col(static_cast<Index>(i)) *
           other.columns.col(same->second).transpose();
  }
  return sum;
}

// Where a probe looks on its face when the head stands at `position`: by hand, for the nominal
// head.
struct Spot {
  int face;
  double along, across;
};
Spot SpotOf(Index probe, double position) {
  const std::array<Spot, 5> places{
      {{0, kArm, 0.0}, {0, 0.0, kArm}, {0, 0.0, -kArm}, {1, 0.0, 20e-3}, {1, kArm, 20e-3}}};
  Spot spot = places[static_cast<std::size_t>(probe)];
  spot.along += position;
  return spot;
}

double Stated(const Spot& one, const Spot& other) {
  if (one.face != other.face) return 0.0;
  return std::exp(-(std::pow(one.along - other.along, 2) + std::pow(one.across - other.across, 2)) /
                  (2.0 * kLength * kLength));
}

// `moved`: what became of a spot by the mounting of the second run.
template <typename Moved>
void ExpectCorrelations(const SweepRun& one, const SweepRun& other, const Moved& moved) {
  const MatrixXd found = Correlation(FormIn(one), FormIn(other));
  double largest = 0.0;
  for (Index i = 0; i < found.rows(); ++i) {
    for (Index j = 0; j < found.cols(); ++j) {
      const Spot left = SpotOf(i / kStations, one.position[i % kStations]);
      const Spot right = moved(SpotOf(j / kStations, other.position[j % kStations]));
      EXPECT_NEAR(found(i, j), Stated(left, right), kOff) << i << " " << j;
      largest = std::max(largest, found(i, j));
    }
  }
  EXPECT_GT(largest, 0.9);
}

TEST(FormOfTarget, CorrelatesAsTheMachineFileSays) {
  const SweepRun run = RunOver(0.0, 60e-3);
  ExpectCorrelations(run, run, [](const Spot& spot) { return spot; });
  const MatrixXd all = Correlation(FormIn(run), FormIn(run));
  EXPECT_LT((all.diagonal().array() - 1.0).abs().maxCoeff(), 1e-8);  // of one length exactly
}

TEST(FormOfTarget, IsTheSameInASweepWithOtherStations) {
  ExpectCorrelations(RunOver(0.0, 60e-3), RunOver(11e-3, 46e-3),
                     [](const Spot& spot) { return spot; });
}

TEST(FormOfTarget, GoesWithATargetThatIsShifted) {
  ExpectCorrelations(RunOver(0.0, 60e-3), RunOver(0.0, 60e-3, {.target_shift = 17e-3}),
                     [](Spot spot) {
                       spot.along -= 17e-3;
                       return spot;
                     });
}

TEST(FormOfTarget, GoesWithATargetThatIsReversed) {
  // Each face by half a turn about its normal in the middle of the travel.
  ExpectCorrelations(RunOver(0.0, 60e-3), RunOver(0.0, 60e-3, {.target_reversed = true}),
                     [](Spot spot) {
                       spot.along = 60e-3 - spot.along;
                       spot.across = -spot.across;
                       return spot;
                     });
}

TEST(FormOfTarget, IsAnotherOneBeforeTheSideUnitOfATurnedHead) {
  const MatrixXd found =
      Correlation(FormIn(RunOver(0.0, 60e-3)), FormIn(RunOver(0.0, 60e-3, {.head_turned = true})));
  EXPECT_EQ(found.bottomRightCorner(2 * kStations, 2 * kStations).norm(), 0.0);
  EXPECT_GT(found.topLeftCorner(3 * kStations, 3 * kStations).maxCoeff(), 0.9);
}

TEST(FormOfTarget, StaysNoiseWhereNoneIsStatedOrItTakesTooManyNumbers) {
  SweepInstrument flat = Instrument();
  flat.target.form = 0.0;
  EXPECT_TRUE(FormIn(RunOver(0.0, 60e-3), flat).blocks.empty());
  SweepInstrument rough = Instrument();
  rough.target.form_length = 0.2e-3;
  EXPECT_TRUE(FormIn(RunOver(0.0, 60e-3), rough).blocks.empty());
}

}  // namespace form_of_target_test
}  // namespace abbe::simulation
