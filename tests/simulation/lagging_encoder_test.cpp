// A pivot whose encoder stays behind by a play, or is ahead by it: what the cause says of each row
// is what a play does between the true angle and the encoder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/causes/registry.h"

namespace abbe::simulation {
namespace lagging_encoder_test {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kRows = 400;
constexpr double kPace = 0.068, kWidth = 60e-6;  // s, rad

double TrueAngle(double time) { return 0.05 * std::sin(0.3 * time); }

// The output of a play of kWidth in each row, by small steps in time from long before on.
VectorXd Driven() {
  constexpr int kSteps = 200;  // of each row
  VectorXd output(kRows);
  double out = TrueAngle(-10.0);
  for (Index step = -150 * kSteps; step < kRows * kSteps; ++step) {
    const double in = TrueAngle(kPace * static_cast<double>(step) / kSteps);
    out = std::clamp(out, in - 0.5 * kWidth, in + 0.5 * kWidth);
    if (step >= 0 && step % kSteps == 0) output[step / kSteps] = out;
  }
  return output;
}

TEST(LaggingEncoder, IsOffAsItsPlayLeavesItWhileThePivotTurnsRound) {
  const VectorXd shown = Driven();
  Trace trace;
  trace.time = trace.clock = VectorXd::LinSpaced(kRows, 0.0, kPace * (kRows - 1));
  trace.pass.assign(kRows, 1);
  trace.direction.assign(kRows, 1);
  trace.SetAngles(shown.transpose());
  const auto columns = JointHysteresis().columns(trace, "pivot_1", VectorXd::Constant(1, -kWidth));
  const Eigen::RowVectorXd added = -kWidth * columns.front().stages().at(kEncoderStage);
  double reversing = 0.0;
  for (Index row = 3; row < kRows - 3; ++row) {
    const double lags = shown[row] - TrueAngle(trace.time[row]);
    EXPECT_NEAR(added[row], lags, 0.03 * kWidth) << row;
    if (std::abs(lags) < 0.45 * kWidth) ++reversing;
  }
  EXPECT_GE(reversing, 4.0);  // rows between the two ends of the play
}

}  // namespace lagging_encoder_test
}  // namespace abbe::simulation
