#include "probes/sweep_reduction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "failure/failure.h"
#include "tests/probes/synthetic_sweep.h"

namespace abbe::probes {
namespace sweep_reduction_test {

SweepSetup NoiseOnly() {
  SweepSetup setup = TestSetup();
  setup.head.tolerance = {};
  setup.target.form = 0.0;
  return setup;
}

const ComponentResult& Of(const SweepResult& result, const std::string& name) {
  for (const ComponentResult& component : result.components) {
    if (component.component.name == name) return component;
  }
  throw std::logic_error(name);
}

Eigen::VectorXd TruthOf(const SyntheticSweep& sweep, double HeadErrors<>::*error) {
  Eigen::VectorXd truth(sweep.stations);
  for (int i = 0; i < sweep.stations; ++i) truth[i] = sweep.errors(i * sweep.step, 1).*error;
  return truth;
}

Eigen::VectorXd FromFirst(const Eigen::VectorXd& values) { return values.array() - values[0]; }

// The residuals of a least-squares line by the normal equations.
Eigen::VectorXd FromLine(const Eigen::VectorXd& values) {
  Eigen::MatrixXd A(values.size(), 2);
  A.col(0).setOnes();
  A.col(1).setLinSpaced(0.0, 1.0);
  return values - A * A.colPivHouseholderQr().solve(values);
}

// A file that was cut off looks like a shorter sweep; its header knows better.
TEST(SweepReduction, NamesWhatTheHeaderPlannedAndTheRecordingLacks) {
  SyntheticSweep sweep{.header =
                           "[sweep]\nstations_mm = [0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, "
                           "60]\npasses = 5\n"};
  const auto lacking = [](const SweepResult& result) {
    return std::ranges::count_if(result.notes, [](const std::string& note) {
      return note.starts_with("the recording lacks");
    });
  };
  const SweepResult whole = ReduceSweep(Record(sweep, TestSetup()), TestSetup());
  EXPECT_EQ(whole.planned->missing_stations + whole.planned->missing_passes, 0);
  EXPECT_EQ(lacking(whole), 0);
  sweep.stations = 4;
  sweep.passes = 1;
  const SweepResult cut = ReduceSweep(Record(sweep, TestSetup()), TestSetup());
  EXPECT_EQ(cut.planned->missing_stations, 9);
  EXPECT_EQ(cut.planned->missing_passes, 4);
  EXPECT_EQ(lacking(cut), 1);
  EXPECT_THAT(cut.notes,
              testing::Contains(testing::HasSubstr("9 of 13 stations and 4 of 5 passes")));
}

// Noise-free: what is left is the zero of the first station, where the truth is not zero: its
// angles (0) and straightness (2 um) enter second order, 2 um * 20 urad.
TEST(SweepReduction, FindsTheErrorsOfAMovingTarget) {
  const SyntheticSweep sweep;
  const SweepResult result = ReduceSweep(Record(sweep, TestSetup()), TestSetup());
  EXPECT_EQ(result.moving, MovingBody::kTarget);
  EXPECT_EQ(result.passes, 5);
  EXPECT_EQ(result.dwells.size(), 130U);
  const auto expect = [&](const std::string& name, const Eigen::VectorXd& truth, double tolerance) {
    EXPECT_LT((Of(result, name).value - truth).cwiseAbs().maxCoeff(), tolerance) << name;
  };
  expect("EAX", FromFirst(TruthOf(sweep, &HeadErrors<>::eax)), 1e-9);
  expect("EBX", FromFirst(TruthOf(sweep, &HeadErrors<>::ebx)), 1e-9);
  expect("ECX", FromFirst(TruthOf(sweep, &HeadErrors<>::ecx)), 1e-9);
  EXPECT_LT((Of(result, "EYX").at_target - FromLine(TruthOf(sweep, &HeadErrors<>::eyx)))
                .cwiseAbs()
                .maxCoeff(),
            1e-10);
  EXPECT_LT((Of(result, "EZX").at_target - FromLine(TruthOf(sweep, &HeadErrors<>::ezx)))
                .cwiseAbs()
                .maxCoeff(),
            1e-10);
}

TEST(SweepReduction, FindsTheErrorsOfAMovingHead) {
  const SyntheticSweep sweep{.axis = 'Z', .moving = MovingBody::kHead};
  const SweepResult result = ReduceSweep(Record(sweep, TestSetup()), TestSetup());
  EXPECT_EQ(result.moving, MovingBody::kHead);
  EXPECT_LT((Of(result, "ECZ").value - FromFirst(TruthOf(sweep, &HeadErrors<>::eax)))
                .cwiseAbs()
                .maxCoeff(),
            1e-9);
  EXPECT_LT((Of(result, "EXZ").at_target + FromLine(TruthOf(sweep, &HeadErrors<>::ezx)))
                .cwiseAbs()
                .maxCoeff(),
            1e-10);
}

TEST(SweepReduction, TheReversalIsForwardMinusBackward) {
  SyntheticSweep sweep;
  sweep.errors = [](double d, int direction) {
    HeadErrors<> e;
    e.ecx = direction * 2e-6 + 1e-3 * d;
    e.eyx = direction * 0.1e-6;
    e.ezx = 10e-6 * d;  // probes that never move are refused
    return e;
  };
  const SweepResult result = ReduceSweep(Record(sweep, NoiseOnly()), NoiseOnly());
  const ComponentResult& yaw = Of(result, "ECX");
  ASSERT_TRUE(yaw.reversal);
  EXPECT_NEAR(yaw.reversal->mean.value, 4e-6, 1e-10);
  EXPECT_NEAR(yaw.reversal->largest.value, 4e-6, 1e-10);
  EXPECT_TRUE((yaw.forward - yaw.backward).isApprox(yaw.reversal->value));
  EXPECT_NEAR(yaw.range->value, 60e-6, 1e-9);
  EXPECT_NEAR(Of(result, "EAX").reversal->mean.value, 0.0, 1e-10);
}

TEST(SweepReduction, OneDirectionHasNoReversal) {
  const SyntheticSweep sweep{.passes = 1, .backward = false, .white = 20e-9};
  const SweepResult result = ReduceSweep(Record(sweep, TestSetup()), TestSetup());
  EXPECT_FALSE(Of(result, "EAX").reversal);
  EXPECT_EQ(Of(result, "EAX").forward.size(), 13);
  EXPECT_EQ(Of(result, "EAX").backward.size(), 0);
  EXPECT_GT(Of(result, "EAX").u[5], 0.0);
  EXPECT_THAT(result.notes, testing::Contains(testing::HasSubstr("one pass")));
}

// Known to a factor of two, lognormal: its mean square is larger by exp(2 ln(2)^2).
TEST(SweepReduction, AFormThatNobodyMeasuredCountsMoreAndIsNamed) {
  SweepSetup setup = TestSetup();
  const recording::Recording recording = Record({.white = 20e-9}, setup);
  const SweepResult stated = ReduceSweep(recording, setup);
  setup.target.form_known_to = 1.0;
  const SweepResult measured = ReduceSweep(recording, setup);
  constexpr std::size_t kForm = kSources - 1;
  const double larger = std::exp(2.0 * std::log(2.0) * std::log(2.0));
  for (std::size_t c = 0; c < kComponents; ++c) {
    EXPECT_NEAR(std::pow(stated.components[c].budget[kForm], 2),
                larger * std::pow(measured.components[c].budget[kForm], 2), 1e-22);
  }
  EXPECT_THAT(stated.notes, testing::Contains(testing::HasSubstr("target.form_nm = 10")));
  EXPECT_THAT(measured.notes, testing::Not(testing::Contains(testing::HasSubstr("form_nm"))));
}

// In one pass the drift may be three times what is stated, and no reversal is seen for it.
TEST(SweepReduction, OnePassKnowsItsNoiseToAFactorOfTwo) {
  SweepSetup setup = NoiseOnly();
  const SweepResult one = ReduceSweep(Record({.passes = 1, .white = 20e-9}, setup), setup);
  const SweepResult five = ReduceSweep(Record({.passes = 5, .white = 20e-9}, setup), setup);
  EXPECT_GT(Of(one, "ECX").u[5], 1.4 * std::sqrt(5.0) * Of(five, "ECX").u[5]);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SyntheticSweep drifting{.passes = 1, .white = 5e-9, .drift = 90e-9, .seed = seed};
    const SweepResult result = ReduceSweep(Record(drifting, setup), setup);
    for (const auto& component : result.components) EXPECT_FALSE(component.reversal->seen) << seed;
  }
}

TEST(SweepReduction, OneDirectionSaysWhatItsErrorsLack) {
  SyntheticSweep sweep{.passes = 3, .backward = false, .white = 20e-9};
  const auto note = testing::HasSubstr(
      "the sweep has forward passes only: the errors are those of this direction");
  EXPECT_THAT(ReduceSweep(Record(sweep, TestSetup()), TestSetup()).notes, testing::Contains(note));
  sweep.backward = true;
  EXPECT_THAT(ReduceSweep(Record(sweep, TestSetup()), TestSetup()).notes,
              testing::Not(testing::Contains(note)));
}

TEST(SweepReduction, TooFewStationsAreRefused) {
  const SyntheticSweep sweep{.stations = 2};
  try {
    ReduceSweep(Record(sweep, TestSetup()), TestSetup());
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("at least 3"));
  }
}

TEST(SweepReduction, MoreScatterThanTheModelSaysRaisesTheUncertaintyAndIsSaid) {
  const SyntheticSweep sweep{.white = 2e-9, .drift = 100e-9};
  SweepSetup setup = NoiseOnly();
  const recording::Recording recording = Record(sweep, setup);
  setup.noise.drift = 100e-9;
  const SweepResult fitting = ReduceSweep(recording, setup);
  EXPECT_DOUBLE_EQ(fitting.noise.scale, 1.0);
  setup.noise.drift = 10e-9;
  const SweepResult doubtful = ReduceSweep(recording, setup);
  EXPECT_GT(doubtful.noise.scale, 1.5);
  EXPECT_GT(doubtful.noise.chi2, 1.5 * 1.5 * doubtful.noise.dof);
  EXPECT_THAT(doubtful.notes, testing::Contains(testing::HasSubstr("scaled up")));
}

// Recordings of one averaged row per dwell: the noise is that between the passes, few degrees of
// freedom, Student's t.
TEST(SweepReduction, OneReadingPerDwellTakesTheNoiseFromThePasses) {
  SyntheticSweep sweep{.stations = 3, .passes = 3, .samples = 1, .backward = false, .white = 20e-9};
  sweep.header = "[sweep]\nsettle_s = 0.0975\n";
  const SweepResult result = ReduceSweep(Record(sweep, NoiseOnly()), NoiseOnly());
  EXPECT_DOUBLE_EQ(result.noise.dof, 5 * 3 * 2);
  EXPECT_NEAR(result.noise.chi2, result.noise.dof, 1e-3 * result.noise.dof);
  EXPECT_NEAR(Of(result, "EBX").coverage, 2.042, 1e-3);  // table of t: 30 degrees of freedom, 95 %
  EXPECT_THAT(result.notes, testing::Contains(testing::HasSubstr("30 degrees of freedom")));
}

// Over 200 seeds with white noise and drift, one station of each component: mean 0, unit variance.
TEST(SweepReduction, PullsHaveUnitVariance) {
  const SweepSetup setup = NoiseOnly();
  SyntheticSweep sweep{.step = 10e-3, .stations = 7, .white = 20e-9, .drift = 30e-9};
  const SweepResult exact =
      ReduceSweep(Record(SyntheticSweep{.step = 10e-3, .stations = 7}, setup), setup);
  double sum = 0.0, squares = 0.0, chi2 = 0.0, dof = 0.0;
  constexpr int kSeeds = 200;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    sweep.seed = static_cast<std::uint64_t>(seed);
    const SweepResult result = ReduceSweep(Record(sweep, setup), setup);
    const auto component = static_cast<std::size_t>(seed % kComponents);
    const Eigen::Index station = 1 + seed % 6;
    const double pull =
        (result.components[component].value[station] - exact.components[component].value[station]) /
        result.components[component].u[station];
    sum += pull;
    squares += pull * pull;
    chi2 += result.noise.chi2;
    dof += result.noise.dof;
  }
  EXPECT_NEAR(sum / kSeeds, 0.0, 2.58 / std::sqrt(kSeeds));
  // 99 % of chi-squared with 200 degrees of freedom: 152.2 to 255.3.
  EXPECT_GT(squares, 152.2);
  EXPECT_LT(squares, 255.3);
  EXPECT_NEAR(chi2, dof,
              2.58 * std::sqrt(2.0 * dof) + 0.02 * dof);  // 2 %: see HuberMean's efficiency
}

}  // namespace sweep_reduction_test
}  // namespace abbe::probes
