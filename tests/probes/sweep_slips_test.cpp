// Recordings whose numbers are not those of the axes and probes, and what was assumed about a head.
#include "probes/sweep_slips.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>
#include <string>

#include "tests/probes/synthetic_sweep.h"

namespace abbe::probes {
namespace sweep_slips_test {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

SyntheticSweep Noisy() {
  SyntheticSweep sweep;
  sweep.passes = 3;
  sweep.samples = 20;
  sweep.stations = 7;
  sweep.white = 20e-9;
  sweep.drift = 30e-9;
  return sweep;
}

// The same sweep with each gap changed, um.
recording::Recording Changed(const std::function<double(double gap, std::size_t probe)>& change) {
  recording::Recording recording = Record(Noisy(), TestSetup());
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    for (double& gap : recording.columns[7 + probe].values) gap = change(gap, probe);
  }
  return recording;
}

std::string SlipRefusalOf(const recording::Recording& recording) {
  try {
    ReduceSweep(recording, TestSetup());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SweepSlips, ASoundSweepHasNoneToTellOf) {
  const SweepResult result = ReduceSweep(Record(Noisy(), TestSetup()), TestSetup());
  for (const std::string& note : result.notes) {
    EXPECT_THAT(note, Not(HasSubstr("slip"))) << note;
    EXPECT_THAT(note, Not(HasSubstr("no noise"))) << note;
  }
}

TEST(SweepSlips, APositionFarOutsideItsTravelIsRefused) {
  SyntheticSweep sweep = Noisy();
  sweep.first = 60e3;  // 60 km
  const std::string swept = SlipRefusalOf(Record(sweep, TestSetup()));
  EXPECT_THAT(swept, HasSubstr("synthetic_X.csv: row "));
  EXPECT_THAT(swept, HasSubstr("x_mm is 6e+07, far outside the travel of 0 to 60 mm"));
  recording::Recording other = Record(Noisy(), TestSetup());
  for (double& z : other.columns[3].values) z = -20363.0;
  EXPECT_THAT(SlipRefusalOf(other), HasSubstr("z_mm is -20363, far outside the travel"));
  // The overrun of a sweep, and a little more, is none.
  sweep.first = -5e-3;
  EXPECT_EQ(SlipRefusalOf(Record(sweep, TestSetup())), "");
}

TEST(SweepSlips, AnAxisThatTheMachineHasNotIsNamed) {
  SweepSetup setup = TestSetup();
  setup.machine.travels[2] = {};
  recording::Recording recording = Record(Noisy(), setup);
  for (double& z : recording.columns[3].values) z = 30.0;
  try {
    ReduceSweep(recording, setup);
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("z_mm is 30, but the machine has no axis Z"));
  }
}

TEST(SweepSlips, ProbesThatNeverMoveAreRefused) {
  EXPECT_THAT(SlipRefusalOf(Changed([](double, std::size_t) { return 100.0; })),
              HasSubstr("probe_a_um shows 100 um in every dwell"));
  EXPECT_THAT(SlipRefusalOf(
                  Changed([](double gap, std::size_t probe) { return probe == 3 ? 31.25 : gap; })),
              HasSubstr("probe_d_um shows 31.25 um in every dwell"));
}

TEST(SweepSlips, GapsThatAreNextToNothingAreRefused) {
  EXPECT_THAT(SlipRefusalOf(Changed([](double, std::size_t) { return 0.0; })),
              HasSubstr("the gaps are 0 um at most"));
  EXPECT_THAT(SlipRefusalOf(Changed([](double gap, std::size_t) { return gap / 1000.0; })),
              HasSubstr("these are not micrometres"));
}

TEST(SweepSlips, NoNoiseAndTooMuchAndPassesThatAgreeTooWellAreTold) {
  SyntheticSweep silent = Noisy();
  silent.white = silent.drift = 0.0;
  EXPECT_THAT(ReduceSweep(Record(silent, TestSetup()), TestSetup()).notes,
              Contains(HasSubstr("probe_a, probe_b, probe_c, probe_d, probe_e show no noise")));
  EXPECT_THAT(ReduceSweep(Record(silent, TestSetup()), TestSetup()).notes,
              Contains(HasSubstr("agree far better than their noise allows")));
  SyntheticSweep loud = Noisy();
  loud.white = 5e-6;
  EXPECT_THAT(ReduceSweep(Record(loud, TestSetup()), TestSetup()).notes,
              Contains(HasSubstr("a slip of units in the scale of the channels")));
}

// The machine of the tests with the head at [x, y, z] mm; empty: not stated.
SweepSetup HeadAt(const std::string& place) {
  std::string text = kTestMachine;
  const std::string stated = "[head.axis_X]\nposition_mm = [20.0, 15.0, 40.0]";
  const std::string put =
      place.empty() ? "[head.axis_X]" : "[head.axis_X]\nposition_mm = [" + place + "]";
  text.replace(text.find(stated), stated.size(), put);
  return TestSetup(text);
}

// What is told of the place of the head is what moving it by 1 mm does.
TEST(SweepAssumptions, ThePlaceOfTheHeadIsToldWithWhatItMoves) {
  const recording::Recording recording = Record(Noisy(), TestSetup());
  const SweepResult assumed = ReduceSweep(recording, HeadAt(""));
  std::string told;
  for (const std::string& note : assumed.notes) {
    if (note.starts_with("head.axis_X.position_mm is not in the machine file")) told = note;
  }
  ASSERT_NE(told, "");
  for (const std::size_t component : {std::size_t{3}, std::size_t{4}}) {
    const std::string name = assumed.components[component].component.name;
    std::istringstream numbers(told.substr(told.find(name + " by ") + 7));
    for (const char* place : {"1, 0, 0", "0, 1, 0", "0, 0, 1"}) {
      double um = -1.0;
      char comma = ' ';
      numbers >> um >> comma;
      const SweepResult moved = ReduceSweep(recording, HeadAt(place));
      const Eigen::VectorXd change =
          moved.components[component].value - assumed.components[component].value;
      const double expected = 1e6 * (change.maxCoeff() - change.minCoeff());
      EXPECT_NEAR(um, expected, 0.06 * expected + 1e-9) << name << " " << place;  // two digits
    }
  }
  for (const std::string& note : ReduceSweep(recording, HeadAt("0, 0, 0")).notes) {
    EXPECT_THAT(note, Not(HasSubstr("head.axis_X.position_mm"))) << note;
  }
}

// Among 2000 means without any reversal 1.3 may be seen; at 95 % each, 100 would be.
TEST(SweepReversal, IsNotSeenWhereThereIsNone) {
  constexpr int kSweeps = 400;
  int seen = 0, beyond_U95 = 0;
  for (int seed = 1; seed <= kSweeps; ++seed) {
    SyntheticSweep sweep = Noisy();
    sweep.samples = 10;
    sweep.seed = static_cast<std::uint64_t>(seed);
    const SweepResult result = ReduceSweep(Record(sweep, TestSetup()), TestSetup());
    for (const ComponentResult& component : result.components) {
      const Uncertain& mean = component.reversal->mean;
      seen += component.reversal->seen ? 1 : 0;
      beyond_U95 += std::abs(mean.value) > component.coverage * mean.u ? 1 : 0;
    }
  }
  EXPECT_LE(seen, 6);         // Poisson of 1.33: more in 0.06 % of all suites
  EXPECT_GT(beyond_U95, 40);  // the noise is there to be taken for a reversal
}

TEST(SweepReversal, IsSeenWhereThereIsOne) {
  SyntheticSweep sweep = Noisy();
  const auto without = sweep.errors;
  sweep.errors = [&](double d, int direction) {
    HeadErrors<> errors = without(d, direction);
    errors.ezx += direction > 0 ? 0.2e-6 : -0.2e-6;
    return errors;
  };
  const SweepResult result = ReduceSweep(Record(sweep, TestSetup()), TestSetup());
  ASSERT_EQ(result.components[4].component.name, "EZX");
  EXPECT_TRUE(result.components[4].reversal->seen);
  EXPECT_NEAR(result.components[4].reversal->mean.value, 0.4e-6, 0.1e-6);
}

}  // namespace sweep_slips_test
}  // namespace abbe::probes
