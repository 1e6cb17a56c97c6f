// The CSV form: what is read, what is refused, and where the message points.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "recording/recording_file.h"
#include "scratch.h"

namespace abbe::recording {
namespace csv_test {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::string_view kHead =
    "# abbe-recording = 1\n"
    "# kind = \"dwell\"\n"
    "time_s,temp_bed_c,flags\n";

class Csv : public testing::Test {
 protected:
  Recording ReadText(std::string_view text) {
    Put(path_, text);
    return Read(path_);
  }
  Recording ReadRows(const std::string& rows) { return ReadText(std::string(kHead) + rows); }
  // The message without the name of the file.
  std::string Refusal(std::string_view text) {
    const std::string message = MessageOf<InputError>([&] { ReadText(text); });
    const std::string name = path_.string();
    EXPECT_TRUE(message.starts_with(name)) << message;
    return message.substr(std::min(name.size(), message.size()));
  }
  std::string RowRefusal(const std::string& rows) { return Refusal(std::string(kHead) + rows); }
  void ExpectRefusal(const std::string& message, std::string_view place, std::string_view part) {
    EXPECT_TRUE(message.starts_with(place)) << message;
    ExpectHas(message, part);
  }

  const Scratch scratch_;
  const std::filesystem::path path_ = scratch_ / "a.csv";
};

TEST_F(Csv, ReadsTheHeaderTheNamesAndTheNumbers) {
  const Recording recording = ReadText(
      "# abbe-recording = 1\n"
      "# kind = \"dwell\"   # why: noise\n"
      "#\n"
      "#   [sources]\n"
      "#probes = \"modbus\"\n"
      "time_s,temp_bed_c,flags,mood\n"
      "0,20.5,0,-1e-3\n"
      "0.25,21,0,+7\n");
  EXPECT_EQ(recording.header,
            "kind = \"dwell\"   # why: noise\n\n  [sources]\nprobes = \"modbus\"\n");
  EXPECT_EQ(recording.rows(), 2u);
  EXPECT_THAT(recording.At("time_s"), ElementsAre(0.0, 0.25));
  EXPECT_THAT(recording.At("temp_bed_c"), ElementsAre(20.5, 21.0));
  EXPECT_THAT(recording.At("mood"), ElementsAre(-1e-3, 7.0));  // a column of the user's own
  EXPECT_THAT(recording.warnings, IsEmpty());
  EXPECT_EQ(recording.name, path_.string());
}

TEST_F(Csv, ToleratesWhatEditorsAndSpreadsheetsDo) {
  const Recording plain = ReadRows("0,20,0\n1,21,0\n");
  for (const std::string text :
       {"\xEF\xBB\xBF# abbe-recording = 1\r\n# kind = \"dwell\"\r\ntime_s,temp_bed_c,flags\r\n"
        "0,20,0\r\n1,21,0\r\n",
        "#abbe-recording=1\n# kind = \"dwell\"\n time_s , temp_bed_c\t,flags \n 0 ,\t20,0 \n1, 21, "
        "0\n",
        "# abbe-recording = 1\n# kind = \"dwell\"\ntime_s,temp_bed_c,flags\n0,20,0\n1,21,0\n\n  "
        "\n"}) {
    const Recording same = ReadText(text);
    EXPECT_EQ(same.header, plain.header);
    EXPECT_THAT(same.warnings, IsEmpty());
    for (const Column& column : plain.columns) {
      EXPECT_THAT(same.At(column.name), testing::ElementsAreArray(column.values));
    }
  }
}

TEST_F(Csv, ReadsAnEmptyFieldAndNanAsNoValue) {
  const Recording recording = ReadRows("0,,2\n1,nan,2\n2, NaN ,2\n3,inf,2\n");
  const auto values = recording.At("temp_bed_c");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(std::isnan(values[i]));
  EXPECT_TRUE(std::isinf(values[3]));
}

TEST_F(Csv, DropsALastLineWithoutAnEnd) {
  for (const std::string cut : {"1", "1,2", "1,21,", "1,21,0"}) {
    const Recording recording = ReadRows("0,20,0\n" + cut);
    EXPECT_EQ(recording.rows(), 1u) << cut;
    ASSERT_EQ(recording.warnings.size(), 1u);
    ExpectHas(recording.warnings.front(), ":5: ");
  }
}

// Wherever a file is cut, it opens with the rows before the cut, or says that none was recorded.
TEST_F(Csv, OpensWhereverItIsCut) {
  const std::string whole = std::string(kHead) + "0,20,0\n1,21.5,0\n2,22,0\n";
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const std::string part = whole.substr(0, size);
    if (size < kHead.size()) {
      ExpectHas(Refusal(part), size < 20 ? "is not a recording" : "nothing was recorded");
      continue;
    }
    const auto lines = static_cast<std::size_t>(std::count(part.begin(), part.end(), '\n'));
    EXPECT_EQ(ReadText(part).rows(), lines - 3);
  }
}

TEST_F(Csv, RefusesRowsThatAreNotRows) {
  ExpectRefusal(RowRefusal("0,20,0\n1,21\n"), ":5: ", "has 2 fields, but there are 3 columns");
  ExpectRefusal(RowRefusal("0,20,0,\n"), ":4: ", "has 4 fields");
  ExpectRefusal(RowRefusal("0,20,5,0\n"), ":4: ", "decimal commas");
  ExpectRefusal(RowRefusal("0,20,0\n\n1,20,0\n"), ":5: ", "blank");
  ExpectRefusal(RowRefusal("0,warm,0\n"), ":4: temp_bed_c: ", "`warm` is not a number");
  ExpectRefusal(RowRefusal("0,2 0,0\n"), ":4: temp_bed_c: ", "`2 0`");
  ExpectRefusal(RowRefusal("0,0x10,0\n"), ":4: temp_bed_c: ", "`0x10`");
  ExpectRefusal(RowRefusal("0,1e999,0\n"), ":4: temp_bed_c: ", "`1e999`");
  ExpectRefusal(RowRefusal("0,+-1,0\n"), ":4: temp_bed_c: ", "`+-1`");
  ExpectRefusal(RowRefusal("0,\"20\",0\n"), ":4: temp_bed_c: ", "is not a number");
  ExpectRefusal(RowRefusal("0,20,0\n# note\n"), ":5: ", "has 1 fields");
  ExpectRefusal(RowRefusal("0," + std::string(2 << 20, '1') + ",0\n"), ":4: ", "longer than 1 MiB");
}

TEST_F(Csv, RefusesHeadsThatAreNotHeads) {
  const std::string first = "# abbe-recording = 1\n";
  const std::string dwell = first + "# kind = \"dwell\"\n";
  ExpectRefusal(Refusal("time_s,flags\n0,0\n"), ":1: ", "# abbe-recording = 1");
  ExpectRefusal(Refusal("# abbe-recording = 2\n"), ":1: ", "version 2");
  ExpectRefusal(Refusal(first + "# kind = sweep\ntime_s\n0\n"), ":2: ", "not valid TOML");
  ExpectRefusal(Refusal(first + "# a = 1\n# b = [1,\ntime_s\n0\n"), ":3: ", "not valid TOML");
  ExpectRefusal(Refusal(first + "# machine = \"m\"\ntime_s\n0\n"), ":2: kind: ", "is missing");
  ExpectRefusal(Refusal(first + "#\n# kind = \"dwel\"\ntime_s\n"),
                ":3: kind: ", "did you mean \"dwell\"");
  ExpectRefusal(Refusal(first + "# kind = 3\ntime_s\n"), ":2: kind: ", "not a kind");
  ExpectRefusal(Refusal(dwell + "time_s;temp_bed_c\n0;1\n"), ":3: ", "semicolons");
  ExpectRefusal(Refusal(dwell + "time_s\ttemp_bed_c\n"), ":3: ", "tabs");
  ExpectRefusal(Refusal(dwell + "time_s,,flags\n"), ":3: ", "column 2 has no name");
  ExpectRefusal(Refusal(dwell + "time_s,a,a\n"), ":3: a: ", "two columns");
  ExpectRefusal(Refusal(dwell + "time_s,a/b\n"), ":3: ", "`a/b`");
  ExpectRefusal(Refusal(dwell + "temp_bed_c,flags\n1,0\n"),
                ":3: time_s: ", "a dwell recording needs");
}

TEST_F(Csv, RefusesOtherFiles) {
  ExpectRefusal(Refusal(""), ": ", "empty");
  ExpectRefusal(Refusal(std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0", 18)),
                ":1: ", "is not a recording");
  ExpectRefusal(Refusal(std::string("\xFF\xFE#\0 \0", 6)), ":1: ", "binary");
  ExpectRefusal(Refusal("\x89HDF\r\n\x1a\n and so on"), ": ", "rename it to .h5");
  ExpectHas(MessageOf<InputError>([&] { Read(scratch_ / "none.csv"); }), "no such file");
  std::filesystem::create_directory(scratch_ / "folder.csv");
  ExpectHas(MessageOf<InputError>([&] { Read(scratch_ / "folder.csv"); }), "folder");
  ExpectHas(MessageOf<InputError>([&] { Read(scratch_ / "a.txt"); }), ".csv, .h5 or .hdf5");
}

// A row that lies across the blocks in which a file is read, and rows that end where a block ends.
TEST_F(Csv, ReadsRowsAcrossBlocks) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  for (const std::size_t shift : {0u, 1u, 5u, 6u, 7u, 8u}) {
    std::string text(kHead);
    text += "0," + std::string(shift, '0') + "20,0\n";
    std::size_t rows = 1;
    while (text.size() < 3 * kBlock) {
      text += fmt::format("{},20.{},0\n", rows, rows % 7);
      ++rows;
    }
    const Recording recording = ReadText(text);
    ASSERT_EQ(recording.rows(), rows);
    for (std::size_t i = 0; i < rows; ++i) {
      ASSERT_EQ(recording.columns[0].values[i], static_cast<double>(i));
    }
  }
}

TEST_F(Csv, WritesTheShortestTextThatReadsBackTheSame) {
  Recording recording = Dwell(4);
  recording.columns[1].values = {0.1, -0.0, 5e-324, 1.0 / 3.0};
  Write(recording, path_);
  EXPECT_EQ(Bytes(path_),
            "# abbe-recording = 1\n# kind = \"dwell\"\ntime_s,temp_column_c,flags\n"
            "0,0.1,0\n0.005,-0,0\n0.01,5e-324,0\n0.015,0.3333333333333333,0\n");
}

}  // namespace csv_test
}  // namespace abbe::recording
