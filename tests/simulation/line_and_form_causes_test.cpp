// Causes that need more of a trace than a way: lines in the means of stays, the form of a target,
// wide electrodes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "simulation/causes/registry.h"
#include "simulation/sweep/target_spots.h"

namespace abbe::simulation {
namespace line_and_form_causes_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTurn = 2.0 * std::numbers::pi;

// Rows are means of so many readings, so far apart.
Trace Stays(Index readings, double apart) {
  Trace trace;
  trace.time = trace.clock = VectorXd::LinSpaced(7, 1.3, 19.7);
  trace.samples = VectorXd::Constant(7, static_cast<double>(readings));
  trace.duration = VectorXd::Constant(7, apart * static_cast<double>(readings - 1));
  return trace;
}

TEST(LineCauses, AStayShowsTheMeanOfItsReadings) {
  for (const double frequency : {3.7, 1.0 / 0.047, 21.2, 50.0}) {
    const Trace trace = Stays(13, 0.047);
    const auto columns = Vibration().columns(trace, "Y", VectorXd::Constant(1, frequency));
    const auto& sine = columns[0].stages().at(Positioning(1));
    const auto& cosine = columns[1].stages().at(Positioning(1));
    for (Index row = 0; row < trace.rows(); ++row) {
      double mean_sine = 0.0, mean_cosine = 0.0;
      for (int reading = 0; reading < 13; ++reading) {
        const double phase = kTurn * frequency * (trace.time[row] + 0.047 * (reading - 6));
        mean_sine += std::sin(phase) / 13.0;
        mean_cosine += std::cos(phase) / 13.0;
      }
      EXPECT_NEAR(sine[row], mean_sine, 1e-9) << frequency;
      EXPECT_NEAR(cosine[row], mean_cosine, 1e-9) << frequency;
    }
  }
}

TEST(LineCauses, VibrationIsToldByFrequencyAmplitudeAndPhase) {
  const Eigen::Vector2d wave = SineAndCosine(0.4e-6, 0.7);
  const VectorXd keys = Vibration().ValuesOf(wave, VectorXd::Constant(1, 17.0));
  EXPECT_DOUBLE_EQ(keys[0], 17.0);
  EXPECT_NEAR(keys[1], 0.4e-6, 1e-18);
  EXPECT_NEAR(keys[2], 0.7, 1e-12);
  EXPECT_TRUE(Vibration()
                  .columns(
                      [] {
                        Trace test = Stays(1, 0.1);
                        test.averages_known = false;
                        return test;
                      }(),
                      "X", VectorXd::Constant(1, 17.0))
                  .empty());
}

// A sweep of X over 60 mm whose top probes look 10 mm aside.
Trace Looking() {
  constexpr Index kRows = 25;
  Trace trace;
  trace.axis = 'X';
  trace.time = trace.clock = VectorXd::LinSpaced(kRows, 0.0, kRows - 1.0);
  trace.head.emplace();
  trace.head->gap = MatrixXd::Constant(5, kRows, 100e-6);
  trace.head->spots = MatrixXd::Zero(10, kRows);
  for (Index probe = 0; probe < 5; ++probe) {
    trace.head->spots.row(2 * probe) = Eigen::RowVectorXd::LinSpaced(kRows, 0.0, 60e-3);
  }
  trace.head->spots.row(3).setConstant(10e-3);
  return trace;
}

TEST(TargetForm, DrawsHaveTheDeviationAndTheLengthOfTheForm) {
  constexpr double kLength = 15e-3;
  const Trace trace = Looking();
  const Scene scene{{&trace}, Eigen::Vector3d::Constant(0.06), 0.0, kLength};
  const Cause cause = TargetForm();
  const auto columns = cause.columns(trace, "target_top", cause.shapes(scene).front());
  // Form of draws of 1: covariance of the spots of probes a and b.
  MatrixXd form = MatrixXd::Zero(2 * trace.rows(), cause.coefficients());
  for (Index c = 0; c < form.cols(); ++c) {
    for (const auto& [stage, values] : columns[static_cast<std::size_t>(c)].stages()) {
      const Index probe = stage - kReadingStage;
      ASSERT_LT(probe, 3) << "only the top unit looks at this face";
      if (probe < 2) form.col(c).segment(probe * trace.rows(), trace.rows()) = values.transpose();
    }
  }
  const MatrixXd covariance = form * form.transpose();
  const MatrixXd& spots = trace.head->spots;
  for (Index i = 0; i < covariance.rows(); ++i) {
    for (Index j = 0; j < covariance.cols(); ++j) {
      const double along = spots(0, i % trace.rows()) - spots(0, j % trace.rows()),
                   across = (i / trace.rows() - j / trace.rows()) * 10e-3;
      const double expected =
          std::exp(-0.5 * (along * along + across * across) / (kLength * kLength));
      EXPECT_NEAR(covariance(i, j), expected, 0.06);  // the grid ends
    }
  }
}

TEST(TargetForm, ASpotKeepsItsCoordinatesWhenTheTargetIsMoved) {
  const auto chain = machine::Chain::Parse("[w b X Y Z t]");
  probes::HeadSettings head{};
  head.axes[0].R_MH = Eigen::Matrix3d::Identity();
  SweepRun run;
  run.axis = 'X';
  run.position = VectorXd::LinSpaced(7, 10e-3, 70e-3);
  const MatrixXd as_mounted = SpotsOnTarget(chain, head, run);
  run.mounted.target_shift = 10e-3;  // one station
  const MatrixXd shifted = SpotsOnTarget(chain, head, run);
  EXPECT_LT((shifted.rightCols(6) - as_mounted.leftCols(6)).norm(), 1e-15);
  run.mounted = {.target_reversed = true};
  const MatrixXd reversed = SpotsOnTarget(chain, head, run);
  EXPECT_LT((reversed.row(0) - as_mounted.row(0).reverse()).norm(), 1e-15);
}

TEST(ProbeTilt, MakesTheGapSmallerAsOfAWideElectrode) {
  Trace trace = Looking();
  trace.head->tilt = MatrixXd::Constant(5, trace.rows(), 2e-3);
  const auto columns = ProbeTiltResponse().columns(trace, "head", {});
  // The disc of radius a over a tilted plane, probes/electrode.h: g (1 + sqrt(1 - (a t / g)^2))
  // / 2.
  constexpr double kRadius = 4e-3, kGap = 100e-6;
  const double edge = kRadius * 2e-3 / kGap;
  const double exact = 0.5 * kGap * (std::sqrt(1.0 - edge * edge) - 1.0);
  const double found = kRadius * kRadius * columns[0].stages().at(kReadingStage + 3)[5];
  EXPECT_NEAR(found, exact, edge * edge * std::abs(exact));
  EXPECT_NEAR(ProbeTiltResponse().ValuesOf(VectorXd::Constant(1, kRadius * kRadius), {})[0],
              kRadius, 1e-15);
}

}  // namespace line_and_form_causes_test
}  // namespace abbe::simulation
