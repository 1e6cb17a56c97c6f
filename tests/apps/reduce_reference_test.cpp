#include "apps/reduce_reference.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace abbe::apps {
namespace reduce_reference_test {

using recording::Recording;

// The example worked by hand in tests/standards/positioning_test.cpp, in micrometres: at 0 mm up 1
// 2 3 and down 0 -2 -4, at 100 mm up 5 5 5 and down 6 9 3. The first reading stands there as two
// rows.
Recording ByHand() {
  Recording recording;
  recording.name = "hand.csv";
  recording.header = "kind = \"reference\"\naxis = \"X\"\n";
  recording.columns = {{"time_s", {}},    {"x_mm", {}},     {"pass", {}},
                       {"direction", {}}, {"ref_x_mm", {}}, {"flags", {}}};
  const auto add = [&](double x, double pass, double direction, double deviation_um,
                       double flags = 0) {
    const double row[] = {
        static_cast<double>(recording.rows()), x, pass, direction, x + deviation_um / 1000, flags};
    for (std::size_t i = 0; i < 6; ++i) recording.columns[i].values.push_back(row[i]);
  };
  add(0, 1, 1, 0.5);
  add(0, 1, 1, 1.5);
  add(100, 1, 1, 5);
  add(100, 1, 1, 700, 1);  // stale
  add(100, 1, -1, 6);
  add(0, 1, -1, 0);
  add(0, 2, 1, 2);
  add(100, 2, 1, 5);
  add(100, 2, -1, 9);
  add(0, 2, -1, -2);
  add(0, 3, 1, 3);
  add(100, 3, 1, 5);
  add(100, 3, -1, 3);
  add(0, 3, -1, -4);
  return recording;
}

std::string Refusal(const Recording& recording) {
  try {
    ReduceReference(recording);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ReduceReference, GivesTheFiguresWorkedByHand) {
  const auto result = ReduceReference(ByHand());
  EXPECT_EQ(result["axis"], "X");
  const auto& figures = result["iso230_2"];
  // Positions of 100 mm in doubles: 1.4e-14 mm, that is 1.4e-11 um, through a few sums.
  const double kRounding = 1e-9;
  EXPECT_NEAR(figures["A_um"], 18, kRounding);
  EXPECT_NEAR(figures["A_up_um"], 5, kRounding);
  EXPECT_NEAR(figures["A_down_um"], 18, kRounding);
  EXPECT_NEAR(figures["R_um"], 12, kRounding);
  EXPECT_NEAR(figures["R_up_um"], 4, kRounding);
  EXPECT_NEAR(figures["R_down_um"], 12, kRounding);
  EXPECT_NEAR(figures["E_um"], 8, kRounding);
  EXPECT_NEAR(figures["E_up_um"], 3, kRounding);
  EXPECT_NEAR(figures["E_down_um"], 8, kRounding);
  EXPECT_NEAR(figures["M_um"], 5.5, kRounding);
  EXPECT_NEAR(figures["B_um"], 4, kRounding);
  EXPECT_NEAR(figures["mean_reversal_um"], 1.5, kRounding);
  EXPECT_EQ(figures["cycles"], 3);
  EXPECT_EQ(figures["left_out_rows"], 1);
  ASSERT_EQ(figures["targets"].size(), 2u);
  EXPECT_NEAR(figures["targets"][1]["target_mm"], 100, kRounding);
  EXPECT_NEAR(figures["targets"][0]["R_um"], 10, kRounding);
}

TEST(ReduceReference, PrintsTheFiguresWithTheirUnit) {
  const std::string table = ReferenceTable(ReduceReference(ByHand()));
  for (const char* line :
       {"ISO 230-2, axis X: 2 targets, 3 cycles in both directions\n",
        "target [mm]    up [um]  down [um]", "    100.0000       5.00       6.00      -1.00",
        "accuracy A                              18.00       5.00      18.00\n",
        "mean reversal (up - down)                1.50\n", "1 flagged rows were left out\n",
        "fewer than the five cycles that ISO 230-2 asks for\n"}) {
    EXPECT_NE(table.find(line), std::string::npos) << line << "not in\n" << table;
  }
}

TEST(ReduceReference, FindsTheAxisByItsReferenceColumn) {
  Recording recording = ByHand();
  recording.header = "kind = \"reference\"\n";
  EXPECT_EQ(ReduceReference(recording)["axis"], "X");
  recording.columns.push_back({"ref_y_mm", std::vector<double>(recording.rows(), 0.0)});
  EXPECT_EQ(Refusal(recording),
            "hand.csv: 2 reference columns: name the moving axis in the header, axis = \"X\"");
}

TEST(ReduceReference, RefusesWhatIsNoPositioningTest) {
  Recording other = ByHand();
  other.header = "kind = \"sweep\"\naxis = \"X\"\n";
  EXPECT_EQ(Refusal(other),
            "hand.csv: kind is \"sweep\", not \"reference\"; ISO 230-2 figures are those of its "
            "targets");

  Recording plane = ByHand();
  plane.header = "kind = \"reference\"\naxis = \"XY\"\n";
  EXPECT_EQ(Refusal(plane),
            "hand.csv: axis = \"XY\": positioning is evaluated along one axis, X, Y or Z");

  Recording still = ByHand();
  still.columns[3].values[4] = 0;
  EXPECT_EQ(
      Refusal(still),
      "hand.csv: row 5 has direction 0: each reading needs the direction of its approach, 1 or -1");

  Recording interrupted = ByHand();
  for (auto& column : interrupted.columns) column.values.pop_back();
  EXPECT_NE(
      Refusal(interrupted).find("hand.csv: ISO 230-2: target 0 mm has 3 cycles up and 2 down"),
      std::string::npos)
      << Refusal(interrupted);

  Recording without = ByHand();
  without.columns[4].name = "other_mm";
  EXPECT_NE(Refusal(without).find("ref_x_mm"), std::string::npos);
}

}  // namespace reduce_reference_test
}  // namespace abbe::apps
