// The recording in memory: its columns and its header.
#include "recording/recording.h"

#include "scratch.h"

namespace abbe::recording {
namespace {

Recording Example() {
  Recording recording = Dwell(3);
  recording.name = "runs/a.csv";
  recording.header =
      "kind = \"dwell\"\nstarted = 2026-11-21T09:00:00Z\n[mounting]\nhead = \"180deg\"\n"
      "target_shift_mm = 2.5\ntarget_reversed = true\nturns = 3\n";
  return recording;
}

TEST(RecordingTest, FindsAColumnByItsName) {
  const Recording recording = Example();
  EXPECT_EQ(recording.rows(), 3u);
  ASSERT_TRUE(recording.Find("time_s").has_value());
  EXPECT_EQ(recording.Find("time_s")->data(), recording.columns[0].values.data());
  EXPECT_FALSE(recording.Find("time").has_value());
  EXPECT_EQ(Recording{}.rows(), 0u);
  const auto message = MessageOf<InputError>([&] { recording.At("probe_a_um"); });
  ExpectHas(message, "runs/a.csv: probe_a_um: ");
}

TEST(RecordingTest, ReadsTheHeaderByDottedPath) {
  const Recording recording = Example();
  EXPECT_EQ(recording.Kind(), "dwell");
  EXPECT_EQ(recording.HeaderText("mounting.head"), "180deg");
  EXPECT_EQ(recording.HeaderText("mounting.target_shift_mm"), "2.5");
  EXPECT_EQ(recording.HeaderText("mounting.target_reversed"), "true");
  EXPECT_EQ(recording.HeaderText("mounting.turns"), "3");
  EXPECT_EQ(recording.HeaderText("started"), "2026-11-21T09:00:00Z");
  EXPECT_FALSE(recording.HeaderText("mounting.probe").has_value());
  EXPECT_FALSE(recording.HeaderText("axis").has_value());
}

TEST(RecordingTest, SaysWhatIsWrongWithAHeader) {
  Recording recording = Example();
  recording.header = "machine = \"m\"\n";
  ExpectHas(MessageOf<InputError>([&] { recording.Kind(); }), "runs/a.csv: the header has no kind");
  recording.header = "kind = dwell\n";
  ExpectHas(MessageOf<InputError>([&] { recording.Kind(); }),
            "runs/a.csv: header line 1: not valid TOML");
}

}  // namespace
}  // namespace abbe::recording
