// The registry of kinds of run against the rules of recordings.
#include "simulation/kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"
#include "recording/check.h"

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
                  "length, plate, shaft, dwell and gap-steps"));
}

}  // namespace kinds_test
}  // namespace abbe::simulation
