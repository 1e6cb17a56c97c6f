// The recording in memory: its columns and its header.
#include "recording/recording.h"

#include "scratch.h"

namespace abbe::recording {
namespace recording_test {

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

TEST(RecordingTest, HandsOutTheNumbersOfTheHeader) {
  Recording recording = Example();
  recording.header = "u_ppm = 2.5\ncount = 3\ntool_mm = [0, 1.5, -2]\nword = \"x\"\nbad = nan\n" +
                     recording.header;
  EXPECT_EQ(recording.HeaderNumber("u_ppm", 0.0), 2.5);
  EXPECT_EQ(recording.HeaderNumber("count"), 3.0);
  EXPECT_FALSE(recording.HeaderNumber("nothing").has_value());
  EXPECT_EQ(recording.HeaderNumbers("tool_mm", 3), (std::vector<double>{0.0, 1.5, -2.0}));
  EXPECT_FALSE(recording.HeaderNumbers("nothing", 3).has_value());
  for (const char* path : {"word", "bad", "tool_mm"}) {
    const auto message = MessageOf<InputError>([&] { recording.HeaderNumber(path); });
    ExpectHas(message, std::string("runs/a.csv: header: ") + path + " is ");
  }
  ExpectHas(MessageOf<InputError>([&] { recording.HeaderNumber("u_ppm", 3.0); }), "at least 3");
  for (const char* path : {"word", "u_ppm"}) {
    ExpectHas(MessageOf<InputError>([&] { recording.HeaderNumbers(path, 3); }), "write 3 numbers");
  }
  ExpectHas(MessageOf<InputError>([&] { recording.HeaderNumbers("tool_mm", 2); }), "2 numbers");
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

}  // namespace recording_test
}  // namespace abbe::recording
