// Waves of the positioning errors that are shorter than the smooth ones: their prior, the slopes of
// their evidence, and which runs show them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>

#include "../folders.h"
#include "fusion/machine_prior.h"
#include "fusion/place_scatter.h"
#include "fusion/population_evidence.h"
#include "geometry/b_spline.h"
#include "machine/machine.h"
#include "random/counter_random.h"
#include "settings/document.h"

namespace abbe::fusion {
namespace waves_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kDegree = 5;
constexpr double kSmooth = 5e-6, kWave = 2e-6;               // m: sizes
constexpr double kSmoothLength = 20e-3, kWaveLength = 2e-3;  // m

class NoResponse : public simulation::Responsive {
 public:
  Index Rows() const override { return 0; }
  void Evaluate(const VectorXd&, VectorXd&, estimation::RowMatrix*) const override {}
  std::shared_ptr<const simulation::Response> At(const VectorXd&) const override { return {}; }
};

class Waves : public testing::Test {
 protected:
  Waves()
      : machine_(machine::ReadMachine(settings::Document::Read(DemoMillFile()).Root())),
        model_(WithWaves(UnknownMachine(machine_), {true, true, true})) {}

  // With waves in EYY alone.
  ErrorPopulation Population() const {
    ErrorPopulation population = PopulationOf(machine_);
    population.deviation(1, 1) = kSmooth;
    population.length(1, 1) = kSmoothLength;
    population.wave[1] = kWave;
    population.wave_length[1] = kWaveLength;
    return population;
  }
  VectorXd Normal(std::uint64_t stream, Index size) const {
    const random::CounterRandom draw(7, stream);
    VectorXd values(size);
    for (Index i = 0; i < size; ++i) values[i] = draw.Normal(static_cast<std::uint64_t>(i));
    return values;
  }
  // The rows of the basis of EYY at these places.
  MatrixXd Basis(const VectorXd& x) const {
    const auto& travel = machine_.travels[1];
    const auto basis = geometry::BSplineBasis::Uniform(kDegree, travel.first, travel.last,
                                                       model_.Function(1, 1).size());
    MatrixXd B(x.size(), basis.size());
    for (Index i = 0; i < x.size(); ++i) B.row(i) = basis.Row(x[i]);
    return B;
  }

  const machine::Machine machine_;
  const machine::VolumetricModel model_;
};

TEST_F(Waves, AreHeldByThePositioningErrorsAlone) {
  const machine::VolumetricModel smooth = UnknownMachine(machine_);
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    EXPECT_TRUE(HoldsWaves(model_, axis));
    EXPECT_FALSE(HoldsWaves(smooth, axis));
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      if (motion == axis) continue;
      EXPECT_EQ(model_.Function(axis, motion).size(), smooth.Function(axis, motion).size());
    }
  }
}

// Variances and covariances of the error itself against the closed form of the two processes.
TEST_F(Waves, HaveTheCovarianceOfTwoProcesses) {
  const MachinePrior prior(machine_, model_, Population());
  const VectorXd x = VectorXd::LinSpaced(25, 2e-3, 56e-3);
  const MatrixXd W = prior.Whitening(1, 1);
  const MatrixXd V = (W.transpose() * W).inverse(), B = Basis(x);
  const MatrixXd found =
      B * V * B.transpose() - std::pow(prior.population().scale, 2) * MatrixXd(x * x.transpose());
  for (Index i = 0; i < x.size(); ++i) {
    for (Index j = 0; j < x.size(); ++j) {
      const double d = x[i] - x[j];
      const double expected = kSmooth * kSmooth * std::exp(-0.5 * std::pow(d / kSmoothLength, 2)) +
                              kWave * kWave * std::exp(-0.5 * std::pow(d / kWaveLength, 2));
      EXPECT_NEAR(found(i, j), expected, 0.01 * kSmooth * kSmooth) << i << " " << j;
    }
  }
}

// A wave of 2 um on a smooth error of 5 um, both drawn: the part that is the wave.
TEST_F(Waves, AreToldFromTheSmoothError) {
  ErrorPopulation smooth = Population(), wave = Population();
  smooth.wave[1] = 0.0;
  wave.deviation(1, 1) = 1e-12;
  smooth.scale = wave.scale = 1e-12;
  const auto draw = [&](const ErrorPopulation& population, std::uint64_t stream) {
    const auto spread = MachinePrior(machine_, model_, population).SpreadOf(1, 1);
    const VectorXd z = Normal(stream, spread.deviations.size());
    return VectorXd(spread.axes * (spread.deviations.asDiagonal() * z));
  };
  const VectorXd of_wave = draw(wave, 1), all = of_wave + draw(smooth, 2);
  const MachinePrior prior(machine_, model_, Population());
  const MatrixXd B = Basis(VectorXd::LinSpaced(200, 5e-3, 55e-3));
  const VectorXd truth = B * of_wave, found = B * (prior.PartOfWave(1) * all);
  EXPECT_GT(truth.norm(), 0.5 * kWave * std::sqrt(200.0));
  EXPECT_LT((found - truth).norm(), 0.5 * truth.norm());
  EXPECT_EQ(MachinePrior(machine_, model_, smooth).PartOfWave(1).size(), 0);
}

// Against differences, for each of theta; H and h of rows drawn at random.
TEST_F(Waves, HaveTheSlopesOfTheirEvidence) {
  const PopulationEvidence evidence(machine_, model_);
  const Index n = evidence.squareness() + 3, rows = 60;
  ASSERT_EQ(evidence.count(), 2 * 18 + 2 + 2 * 3);
  MatrixXd J(rows, n);
  for (Index row = 0; row < rows; ++row) {
    J.row(row) = Normal(10 + static_cast<std::uint64_t>(row), n).transpose() * 3e5;
  }
  const Quadratic seen{J.transpose() * J, J.transpose() * Normal(3, rows)};
  const VectorXd theta = 0.3 * Normal(4, evidence.count());
  const auto slopes = evidence.SlopesAt(seen, theta, evidence.At(seen, theta));
  const auto log = [&](const VectorXd& at) {
    return evidence.At(seen, at).log + 0.5 * at.dot(evidence.precision() * at);
  };
  constexpr double kStep = 1e-3;
  for (Index i = 0; i < evidence.count(); ++i) {
    const VectorXd step = kStep * VectorXd::Unit(evidence.count(), i);
    const double expected = (log(theta + step) - log(theta - step)) / (2.0 * kStep);
    EXPECT_NEAR(slopes.gradient[i], expected, 0.02 * std::abs(expected) + 2e-3) << i;
  }
}

// EYY read at 200 places with a noise of 0.1 um: 10 um of a smooth error, with a wave of 1 um and without.
TEST_F(Waves, AreEvidentWhereTheyAreThere) {
  const PopulationEvidence evidence(machine_, model_);
  const Index n = evidence.squareness() + 3, rows = 200;
  constexpr double kNoise = 1e-7;
  VectorXd y(rows);
  const random::CounterRandom draw(7, 20);
  for (Index i = 0; i < rows; ++i) y[i] = draw.Uniform(static_cast<std::uint64_t>(i), 0.0, 60e-3);
  Index first = 0;
  for (int motion = 0; motion < machine::kMotions; ++motion) {
    first += model_.Function(0, motion).size();
  }
  MatrixXd J = MatrixXd::Zero(rows, n);
  const Index at = first + model_.Function(1, 0).size();
  J.middleCols(at, model_.Function(1, 1).size()) = Basis(y) / kNoise;
  const VectorXd smooth = 10e-6 * (y.array() / 8e-3).sin(), noise = kNoise * Normal(21, rows);
  const VectorXd wave = 1e-6 * (y.array() / 0.8e-3).sin();
  const auto evident = [&](const VectorXd& read) {
    const Quadratic seen{J.transpose() * J, J.transpose() * (read / kNoise)};
    const VectorXd theta =
        evidence.Maximise(seen, evidence.AtBestLength(seen), evidence.count()).theta;
    return evidence.EvidentWaves(seen, theta);
  };
  using OfAxes = std::array<bool, machine::kAxes>;
  EXPECT_EQ(evident(smooth + wave + noise), (OfAxes{false, true, false}));
  EXPECT_EQ(evident(smooth + noise), (OfAxes{false, false, false}));
}

// 125 places on the planes of a grid, and up to a millimetre off them.
TEST_F(Waves, MayBeShownByPlacesThatAreNotOnFewPlanes) {
  simulation::SimulatedRun run{"space", "linkage", {}, nullptr};
  run.response = std::make_shared<NoResponse>();
  run.commanded.resize(3, 125);
  const random::CounterRandom draw(7, 30);
  for (Index i = 0; i < 125; ++i) {
    run.commanded.col(i) =
        14e-3 * Eigen::Vector3d(static_cast<double>(i % 5), static_cast<double>(i / 5 % 5),
                                static_cast<double>(i / 25));
    run.commanded(1, i) += draw.Uniform(static_cast<std::uint64_t>(i), -1e-3, 1e-3);
  }
  using OfAxes = std::array<bool, machine::kAxes>;
  EXPECT_EQ(ThatMayShowWaves({run}), (OfAxes{false, true, false}));
  run.response = nullptr;
  EXPECT_EQ(ThatMayShowWaves({run}), (OfAxes{false, false, false}));
}

}  // namespace waves_test
}  // namespace abbe::fusion
