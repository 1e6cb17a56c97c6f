// The covariance of the readings of a sweep against its closed form, term by term.
#include <gtest/gtest.h>

#include <cmath>

#include "simulation/sweep/sweep_response.h"

namespace abbe::simulation {
namespace sweep_noise_test {

constexpr double kWhite = 20e-9, kDeparture = 60e-9, kRange = 400e-6;

SweepInstrument Instrument() {
  SweepInstrument instrument{};
  instrument.head.layout = probes::NominalLayout(10e-3);
  for (auto& axis : instrument.head.axes) axis.R_MH = Eigen::Matrix3d::Identity();
  for (auto& probe : instrument.head.probes) probe.range = kRange;
  instrument.head.tolerance.linearity = kDeparture;
  return instrument;
}

// Two near gaps and one far away, of each probe.
SweepRun ThreeGaps() {
  SweepRun run;
  run.axis = 'X';
  run.position = Eigen::Vector3d(0.0, 10e-3, 20e-3);
  run.gap = Eigen::RowVector3d(200e-6, 210e-6, 320e-6).replicate(kProbes, 1);
  for (auto& covariance : run.covariance) {
    covariance = kWhite * kWhite * Eigen::Matrix3d::Identity();
  }
  return run;
}

TEST(SweepNoise, ProbesDepartFromTheirCharacteristicAsTheirGapsAreApart) {
  const SweepInstrument instrument = Instrument();
  const SweepRun run = ThreeGaps();
  const FaceNoise noise = FaceNoiseOf(MakeSweepPlan(machine::Chain::Parse("[w b X Y Z t]"),
                                                    Eigen::Vector3d::Zero(), instrument.head, run),
                                      instrument, run);
  const double variance = kDeparture * kDeparture;
  for (const auto& factor : noise.factors) {
    const Eigen::MatrixXd V = factor.reconstructedMatrix();
    for (Eigen::Index first = 0; first < V.rows(); first += 3) {
      EXPECT_NEAR(V(first, first), kWhite * kWhite + variance, 1e-9 * variance);
      // 10 um are 0.4 lengths of 25 um.
      EXPECT_NEAR(V(first, first + 1), variance * std::exp(-0.08), 1e-9 * variance);
      EXPECT_NEAR(V(first, first + 2), 0.0, 1e-4 * variance);
    }
    EXPECT_EQ(V(0, 4), 0.0);  // another probe, another characteristic
  }
  EXPECT_FALSE(noise.independent);
}

}  // namespace sweep_noise_test
}  // namespace abbe::simulation
