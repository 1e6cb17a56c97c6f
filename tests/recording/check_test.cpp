// The rules of each kind, told by the row that breaks them.
#include "recording/check.h"

#include <cmath>
#include <limits>

#include "recording/recording_file.h"
#include "scratch.h"

namespace abbe::recording {
namespace check_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A recording of three good rows with these columns.
Recording Good(const std::string& kind, const std::vector<std::string>& names) {
  Recording recording;
  recording.name = "good";
  recording.header = "kind = \"" + kind + "\"\n";
  for (const std::string& name : names) recording.columns.push_back({name, {1.0, 1.0, 1.0}});
  return recording;
}

std::vector<std::string> Needs(const std::string& kind) {
  if (kind == "sweep" || kind == "gap-steps") {
    return {"time_s",     "x_mm",       "y_mm",       "z_mm",       "pass",      "direction",
            "probe_a_um", "probe_b_um", "probe_c_um", "probe_d_um", "probe_e_um"};
  }
  if (kind == "linkage") return {"time_s", "x_mm", "y_mm", "z_mm", "pivot_1_rad"};
  if (kind == "reference") return {"x_mm", "ref_x_mm"};
  if (kind == "shaft") return {"time_s", "shaft_deg"};
  if (kind == "length") return {"x_mm", "y_mm", "z_mm", "length_mm"};
  if (kind == "plate") return {"x_mm", "y_mm", "z_mm", "setup", "hole", "plate_x_mm", "plate_y_mm"};
  return {"time_s"};
}

class EachKind : public testing::TestWithParam<std::string> {
 protected:
  const Scratch scratch_;
};

TEST_P(EachKind, NeedsItsColumnsAndNoOther) {
  const std::vector<std::string> names = Needs(GetParam());
  for (const std::string file : {"a.csv", "a.h5"}) {
    Write(Good(GetParam(), names), scratch_ / file);
    EXPECT_EQ(Read(scratch_ / file).Kind(), GetParam());
    for (std::size_t missing = 0; missing < names.size(); ++missing) {
      std::vector<std::string> fewer = names;
      fewer[missing] = "other";
      const auto message =
          MessageOf<InputError>([&] { Write(Good(GetParam(), fewer), scratch_ / file); });
      ExpectHas(message, names[missing]);
      ExpectHas(message, GetParam());
      const std::string header = "kind = \"" + GetParam() + "\"";
      MessageOf<InputError>([&] { Writer::Create(scratch_ / ("new_" + file), header, fewer); });
      EXPECT_FALSE(std::filesystem::exists(scratch_ / ("new_" + file)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EachKind,
                         testing::Values("sweep", "linkage", "reference", "length", "plate",
                                         "dwell", "gap-steps", "shaft"),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// A value that breaks a rule in the second row is refused there in both forms, and let pass where
// the row carries a flag, unless the rule holds for every row.
struct Broken {
  std::string column;
  double value;
  bool always;
};

class EachRule : public testing::TestWithParam<Broken> {
 protected:
  const Scratch scratch_;
};

TEST_P(EachRule, NamesTheRowAndTheColumn) {
  const auto& [column, value, always] = GetParam();
  std::vector<std::string> names{"time_s"};
  if (column != "time_s" && column != "flags") names.push_back(column);
  Recording recording = Good("dwell", names);
  recording.columns.push_back({"flags", {0.0, 0.0, 0.0}});
  for (Column& each : recording.columns) {
    if (each.name == column) each.values[1] = value;
  }
  const auto message = MessageOf<InputError>([&] { Write(recording, scratch_ / "a.h5"); });
  ExpectHas(message, "a.h5: row 2: " + column + ": ");
  recording.columns.back().values[1] = column == "flags" ? value : 2.0;
  if (always) {
    MessageOf<InputError>([&] { Write(recording, scratch_ / "a.h5"); });
  } else {
    Write(recording, scratch_ / "a.h5");
    Write(recording, scratch_ / "a.csv");
    EXPECT_EQ(Read(scratch_ / "a.csv").rows(), 3u);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rules, EachRule,
    testing::Values(Broken{"time_s", kNan, true}, Broken{"time_s", 0.5, true},
                    Broken{"flags", -1.0, true}, Broken{"flags", 32.0, true},
                    Broken{"flags", 1.5, true}, Broken{"flags", kNan, true},
                    Broken{"direction", 2.0, false}, Broken{"direction", 0.5, false},
                    Broken{"pass", -1.0, false}, Broken{"pass", 1.5, false},
                    Broken{"probe_a_um", -0.001, false}, Broken{"probe_e_um", kNan, false},
                    Broken{"probe_a_um", kInfinity, false}, Broken{"x_mm", kNan, false},
                    Broken{"feed_mm_min", -1.0, false}, Broken{"pivot_12_rad", kNan, false},
                    Broken{"ref_y_mm", kNan, false}, Broken{"length_mm", -1.0, false},
                    Broken{"u_length_um", -0.1, false}, Broken{"setup", 0.5, false},
                    Broken{"hole", -1.0, false}, Broken{"plate_x_mm", kNan, false},
                    Broken{"temp_bed_c", kNan, false}, Broken{"cap_force_n", kNan, false}));

TEST(Check, LetsColumnsOfTheUsersOwnHoldAnything) {
  const Scratch scratch;
  Recording recording = Good("dwell", {"time_s", "mood", "probed"});
  recording.columns[1].values = {kNan, kInfinity, -1e300};
  Write(recording, scratch / "a.csv");
  const Recording back = Read(scratch / "a.csv");
  EXPECT_TRUE(std::isnan(back.At("mood")[0]));
  EXPECT_EQ(back.At("mood")[2], -1e300);
}

TEST(Check, LetsTwoRowsShareATime) {
  const Scratch scratch;
  Write(Good("dwell", {"time_s"}), scratch / "a.csv");
  EXPECT_EQ(Read(scratch / "a.csv").rows(), 3u);
}

TEST(Check, NamesTheLineOfACsv) {
  const Scratch scratch;
  Put(scratch / "a.csv",
      "# abbe-recording = 1\n# kind = \"dwell\"\n# machine = "
      "\"m\"\ntime_s,temp_a_c\n0,1\n2,1\n1,1\n");
  ExpectHas(MessageOf<InputError>([&] { Read(scratch / "a.csv"); }),
            "a.csv:7: time_s: goes back from 2 to 1");
  Put(scratch / "a.csv", "# abbe-recording = 1\n# kind = \"dwell\"\ntime_s,temp_a_c\n0,1\n2,\n");
  ExpectHas(MessageOf<InputError>([&] { Read(scratch / "a.csv"); }), "a.csv:5: temp_a_c: is nan");
}

// Row 5 stands in the second block.
TEST(RowCheck, RemembersTheBlockBefore) {
  Recording first = Dwell(4), second = Dwell(2);
  second.first_row = 4;
  const auto take = [&] {
    RowCheck check(Places{"a.h5"});
    check.Take(first);
    check.Take(second);
  };
  ExpectHas(MessageOf<InputError>(take), "a.h5: row 5: time_s: goes back from 0.015 to 0");
  for (double& time : second.columns[0].values) time += 1.0;
  take();
  second.columns[1].values[1] = std::numeric_limits<double>::quiet_NaN();
  ExpectHas(MessageOf<InputError>(take), "a.h5: row 6: temp_column_c: is nan");
}

TEST(Check, RefusesColumnsOfTwoLengths) {
  const Scratch scratch;
  Recording recording = Good("dwell", {"time_s", "mood"});
  recording.columns[1].values.pop_back();
  ExpectHas(MessageOf<InputError>([&] { Write(recording, scratch / "a.csv"); }),
            "mood: has 2 rows, but time_s has 3");
}

}  // namespace check_test
}  // namespace abbe::recording
