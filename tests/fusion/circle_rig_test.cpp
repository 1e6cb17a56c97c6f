// Causes of circles on machines of the rig: smooth errors alone must not pass for backlash or
// reversal spikes, and true backlash must still be found.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../folders.h"
#include "fusion/circle_causes.h"
#include "machine/machine.h"
#include "rig/record_course.h"
#include "settings/document.h"

namespace abbe::fusion {
namespace circle_rig_test {

constexpr int kWorlds = 100;
constexpr double kRadius = 0.020, kMiddle = 0.030;  // m
constexpr double kBacklash = 5e-6;
constexpr double kCoverage = 2.0;

const settings::Document& MachineFile() {
  static const auto document = settings::Document::Read(DemoMillFile());
  return document;
}

paths::MeasuredPath Circle(std::uint64_t seed, double feed) {
  const settings::Table root = MachineFile().Root();
  const rig::LinkageRig rig(rig::World(rig::ReadRigSettings(root), seed),
                            rig::Linkage(rig::ReadLinkage(root), seed));
  rig::CircleProgram program;
  program.centre = Eigen::Vector3d::Constant(kMiddle);
  program.radius = kRadius;
  program.feed = feed;
  return paths::ReferencePath(rig.Record(CircleCourse(program), {.kind = "reference"}));
}

// X trails its command by half the backlash.
void AddBacklash(paths::MeasuredPath& path) {
  for (Eigen::Index i = 0; i < path.poses(); ++i) {
    const double towards = -path.direction[i] * (path.commanded(1, i) - kMiddle);
    path.measured(0, i) -= kBacklash / 2.0 * (towards > 0.0 ? 1.0 : -1.0);
  }
}

enum class Smooth { kPopulation, kAnySize, kNone };

CircleCauses CausesOf(const std::vector<paths::MeasuredPath>& paths, Smooth smooth) {
  const std::vector<paths::CircleRun> runs = paths::CircleRuns(paths);
  CauseOptions options;
  if (smooth == Smooth::kNone) options.smooth.clear();
  if (smooth == Smooth::kPopulation) {
    options.smooth = SmoothHarmonics(machine::ReadMachine(MachineFile().Root()), runs.front());
  }
  std::vector<const paths::CircleRun*> all;
  all.reserve(runs.size());
  for (const paths::CircleRun& run : runs) all.push_back(&run);
  return FitCircleCauses(all, options);
}

// Scales, squareness and bows of the axes are really there; these are not.
bool IsAbsent(const CauseEstimate& one) {
  return one.cause == "backlash" || one.cause == "reversal_spike" ||
         one.cause == "servo_mismatch" || one.cause == "servo_lag_squared";
}

struct Counts {
  int judged = 0, starred = 0;
};

void Count(const CircleCauses& found, Counts& counts) {
  for (const CauseEstimate& one : found.causes) {
    if (!IsAbsent(one)) continue;
    ++counts.judged;
    if (std::abs(one.value) > kCoverage * one.u) ++counts.starred;
  }
}

// A share of 4.55 % lies beyond two standard uncertainties; these are taken up to 6 % too large
// (circle_causes_test.cpp), which leaves 3.4 %. Backlash and spike of an axis err together, so the
// 600 decisions count as 300; three standard deviations to each side.
void ExpectNominal(const Counts& counts) {
  ASSERT_EQ(counts.judged, 6 * kWorlds);
  const auto band = [](double share) { return 3.0 * std::sqrt(share * (1.0 - share) / 300.0); };
  const double starred = static_cast<double>(counts.starred) / counts.judged;
  EXPECT_GT(starred, 0.034 - band(0.034));
  EXPECT_LT(starred, 0.0455 + band(0.0455));
}

TEST(CircleOnTheRig, SmoothErrorsPassForNoOtherCauseAndBacklashIsFound) {
  Counts known, unknown, naive;
  int found = 0, within = 0;
  for (int seed = 1; seed <= kWorlds; ++seed) {
    std::vector<paths::MeasuredPath> paths{Circle(seed, 0.02), Circle(seed, 0.1)};
    Count(CausesOf(paths, Smooth::kPopulation), known);
    Count(CausesOf(paths, Smooth::kAnySize), unknown);
    Count(CausesOf(paths, Smooth::kNone), naive);
    for (paths::MeasuredPath& path : paths) AddBacklash(path);
    for (const CauseEstimate& one : CausesOf(paths, Smooth::kPopulation).causes) {
      if (one.cause != "backlash" || one.object != "X") continue;
      if (one.seen && std::abs(one.value) > kCoverage * one.u) ++found;
      if (std::abs(one.value - kBacklash) < 3.0 * one.u) ++within;
    }
  }
  ExpectNominal(known);
  ExpectNominal(unknown);
  EXPECT_EQ(found, kWorlds);
  EXPECT_GE(within, kWorlds - 3);  // 0.3 % lie beyond three standard uncertainties
  // What the terms of the smooth errors are for.
  EXPECT_GT(naive.starred, 5 * known.starred);
  RecordProperty("starred", known.starred);
  RecordProperty("starred_any_size", unknown.starred);
  RecordProperty("starred_without_terms", naive.starred);
}

// What the population says of the harmonics beside what a hundred machines have of them.
TEST(CircleOnTheRig, SmoothHarmonicsHaveThePopulationsSize) {
  std::vector<double> squares(3), stated;
  double rows = 0.0;
  for (int seed = 1; seed <= kWorlds; ++seed) {
    const auto runs = paths::CircleRuns({Circle(seed, 0.1)});
    stated = SmoothHarmonics(machine::ReadMachine(MachineFile().Root()), runs.front());
    const auto figures = paths::EvaluateCircle(runs.front(), {.cutoff = 0.0, .harmonics = 6});
    rows =
        static_cast<double>(std::ranges::count(runs.front().points, 1, &paths::CirclePoint::sense));
    for (const standards::Harmonic& wave : figures.ccw->harmonics) {
      if (wave.order < kFirstHarmonic || wave.order > 6) continue;
      squares[static_cast<std::size_t>(wave.order - kFirstHarmonic)] +=
          wave.Amplitude() * wave.Amplitude() / 2.0;
    }
  }
  for (std::size_t k = 0; k < squares.size(); ++k) {
    // With the noise of the grid encoder, 0.3 um a row. Two hundred squares: their mean is known to
    // 10 %, its root to 5 %, three of them 15 %.
    const double expected = std::hypot(stated[k], 0.3e-6 * std::sqrt(2.0 / rows));
    EXPECT_NEAR(std::sqrt(squares[k] / kWorlds) / expected, 1.0, 0.15) << "order " << k + 4;
  }
}

}  // namespace circle_rig_test
}  // namespace abbe::fusion
