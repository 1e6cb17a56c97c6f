// The registry of kinds of run against the rules of recordings.
#include "simulation/kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"
#include "fusion/machine_prior.h"
#include "recording/check.h"
#include "tests/diagnosis/arm_world.h"
#include "tests/diagnosis/shaft_world.h"

namespace abbe::simulation {
namespace kinds_test {

recording::Recording HeadOf(std::string_view kind, const std::vector<std::string>& columns) {
  recording::Recording head;
  head.name = "head.csv";
  head.header = "kind = \"" + std::string(kind) + "\"\n";
  for (const std::string& column : columns) head.columns.push_back({column, {}});
  return head;
}

TEST(RunKinds, AreThoseOfRecordings) {
  std::set<std::string_view> of_registry;
  for (const RunKind* kind : RunKinds()) of_registry.insert(kind->name());
  std::set<std::string_view> of_recordings{"arm"};  // a linkage without axes
  for (const std::string_view kind : recording::KnownKinds()) {
    of_recordings.insert(kind);
    EXPECT_EQ(KindOf(HeadOf(kind, recording::RequiredColumns(kind))).name(), kind);
  }
  EXPECT_EQ(of_registry, of_recordings);
}

TEST(RunKinds, ASpecialCaseIsTakenByItsOwnKind) {
  EXPECT_EQ(KindOf(HeadOf("linkage", {"time_s", "ref_x_mm", "ref_y_mm", "ref_z_mm"})).name(),
            "arm");
  EXPECT_EQ(KindOf(HeadOf("dwell", {"time_s", "shaft_deg", "gap_1_mm"})).name(), "shaft");
}

TEST(RunKinds, AnUnknownKindIsNamed) {
  EXPECT_THAT([] { KindOf(HeadOf("voltage", {})); },
              testing::ThrowsMessage<InputError>(
                  "head.csv: kind is \"voltage\"; known are sweep, arm, linkage, reference, "
                  "ballbar, length, plate, shaft, dwell and gap-steps"));
}

struct FactsOfAnotherKind : RunFacts {};

recording::Recording TwoLinesOfAReference() {
  recording::Recording recording = HeadOf("reference", {});
  recording.columns = {{"time_s", {0.0, 1.0}},
                       {"x_mm", {0.0, 1.0}},
                       {"y_mm", {0.0, 0.0}},
                       {"z_mm", {0.0, 0.0}},
                       {"ref_x_mm", {0.0, 1.0}}};
  return recording;
}

TEST(RunKinds, ARunWithTheNameOfAnotherKindIsRefused) {
  const Instruments on_wheel = SetupOfWheel(), on_arm = ArmWorld::SetupOf();
  const auto model = fusion::UnknownMachine(on_wheel.machine);
  const auto refused = [&](const RunKind& kind, const recording::Recording& recording,
                           const Instruments& on) {
    const FactsByRun known{{recording.name, std::make_shared<const FactsOfAnotherKind>()}};
    EXPECT_THAT([&] { kind.Prepare(recording, model, on, known); },
                testing::ThrowsMessage<InputError>(
                    recording.name +
                    ": a run of another kind has the same name; name each recording differently"));
  };
  refused(ShaftKind(), WheelUnderSensors({}, 1).Record("wheel.csv"), on_wheel);
  refused(ArmKind(), ArmWorld::Record(1), on_arm);
  refused(ReferenceKind(), TwoLinesOfAReference(), on_wheel);
}

TEST(RunKinds, FactsAreOfTheRunOfThatName) {
  const auto facts = std::make_shared<const FactsOfAnotherKind>();
  const FactsByRun known{{"a.csv", facts}};
  EXPECT_EQ(FactsAs<FactsOfAnotherKind>(known, "a.csv"), facts);
  EXPECT_EQ(FactsAs<FactsOfAnotherKind>(known, "b.csv"), nullptr);
}

TEST(RunKinds, NoLengthIsMeasuredAlongAnAxisWithoutTravel) {
  Instruments on = SetupOfWheel();
  on.machine.travels[1].last = on.machine.travels[1].first;
  std::vector<std::string> axes;
  for (const NextRun& next : LengthKind().NextRuns({}, on, {})) {
    axes.push_back(next.path.HeaderText("axis").value_or(""));
  }
  EXPECT_THAT(axes, testing::ElementsAre("X", "Z"));
}

}  // namespace kinds_test
}  // namespace abbe::simulation
