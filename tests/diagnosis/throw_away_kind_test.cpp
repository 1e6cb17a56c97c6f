// A kind of run that nobody knows: a level on the table that reads its own offset. All that it
// takes is this file and the line that adds it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "diagnosis/campaign.h"
#include "diagnosis/fit.h"
#include "diagnosis/hold_out.h"
#include "map/error_map.h"
#include "simulation/kinds.h"
#include "tests/diagnosis/planned_circles.h"

namespace abbe::diagnosis {
namespace throw_away_kind_test {

using Eigen::VectorXd;
using recording::Recording;

constexpr double kNoise = 1e-6;  // rad

// residual = (level - offset) / noise
class LevelKind : public simulation::RunKind {
 public:
  std::string_view name() const override { return "level"; }
  bool Takes(const Recording& head) const override { return head.Kind() == name(); }
  bool MakesMaps() const override { return true; }
  std::vector<simulation::SimulatedRun> ForMap(const simulation::RunSource& source,
                                               const machine::VolumetricModel&,
                                               const simulation::Instruments&) const override {
    return {Simulated(source.whole())};
  }
  simulation::PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel&,
                                   const simulation::Instruments&,
                                   const simulation::FactsByRun&) const override {
    simulation::PreparedRuns prepared;
    prepared.runs.push_back({Simulated(recording), {}});
    prepared.notes = {"a level"};
    return prepared;
  }
  simulation::RowRule HeldOut(const Recording&) const override {
    return [](std::size_t row) { return row % 2 == 1; };
  }

 private:
  static simulation::SimulatedRun Simulated(const Recording& recording) {
    const auto level = recording.At("level_urad");
    VectorXd reading(static_cast<Eigen::Index>(level.size()));
    std::copy(level.begin(), level.end(), reading.begin());
    reading *= 1e-6 / kNoise;
    estimation::ParameterBlock offset("level_offset", {"urad", 1e-6},
                                      {{.name = "z", .prior_sd = estimation::kNoPrior}});
    return {recording.name,
            "level",
            {offset},
            std::make_shared<estimation::LinearResidual>(
                VectorXd::Constant(reading.size(), 1.0 / kNoise), reading)};
  }
};

const LevelKind& Level() {
  static const LevelKind kind;
  [[maybe_unused]] static const bool added = (simulation::AddRunKind(kind), true);
  return kind;
}

Recording Levels() {
  Recording recording;
  recording.name = "level.csv";
  recording.header = "kind = \"level\"\n";
  recording.columns = {{"time_s", {0.0, 1.0, 2.0, 3.0}}, {"level_urad", {4.0, 6.0, 4.0, 6.0}}};
  return recording;
}

TEST(ThrowAwayKind, IsDiagnosedAndHeldOutLikeAnyOther) {
  Level();
  Campaign campaign(DemoInstruments());
  campaign.Add(Levels());
  EXPECT_THAT(campaign.notes(), testing::Contains("a level"));
  const Fit fit(campaign);
  EXPECT_NEAR(fit.result().Block("level_offset").Values()[0], 5e-6, 1e-12);
  const HeldOutGain gain = HoldOut(campaign, {Levels()}, {});
  EXPECT_EQ(gain.rows, 2);
  EXPECT_NEAR(gain.before, 2.0, 1e-6);  // kept rows say 4 urad, those held out 6
}

TEST(ThrowAwayKind, EntersAnErrorMap) {
  Level();
  const auto instruments = DemoInstruments();
  const auto runs = simulation::SimulateForMap(
      simulation::SourceOf(Levels()), fusion::UnknownMachine(instruments.machine), instruments);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].kind, "level");
  // A map states the kind by its name, whichever it is.
  map::MapOrigin origin;
  origin.sources[3] = runs[0].kind;
  EXPECT_EQ(origin.SourceOf(3), "level");
  EXPECT_EQ(origin.SourceOf(4), map::kPriorOnly);
}

}  // namespace throw_away_kind_test
}  // namespace abbe::diagnosis
