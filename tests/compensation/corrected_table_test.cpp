#include "compensation/corrected_table.h"

#include <algorithm>

#include "failure/failure.h"
#include "map/words.h"
#include "map_cases.h"

namespace abbe::compensation {
namespace corrected_table_test {

using Eigen::Vector3d;

TEST(CorrectedTable, CorrectsThePositionsAndKeepsTheRest) {
  const map::ErrorMap map = map::RandomMap(2);
  const Corrector corrector(map, Vector3d::Zero());
  const CorrectedTable table = CorrectTable(
      "# part 7\nname,z_mm,x_mm,y_mm,note\nhole 1,10,20,30,\"a, b\"\nhole 2,1e1,20.0,+30,\n",
      "t.csv", corrector);
  EXPECT_EQ(table.rows, 2);
  EXPECT_TRUE(table.text.starts_with("# part 7\nname,z_mm,x_mm,y_mm,note\nhole 1,"));
  const Vector3d made = corrector.Made({0.02, 0.03, 0.01});
  const std::string row = table.text.substr(table.text.find("hole 2"));
  const auto words = map::PartsOf(row, ',');
  EXPECT_NEAR(map::NumberOf(words[1], "z"), 1e3 * made.z(), 1e-13);
  EXPECT_NEAR(map::NumberOf(words[2], "x"), 1e3 * made.x(), 1e-13);
  EXPECT_NEAR(map::NumberOf(words[3], "y"), 1e3 * made.y(), 1e-13);
  EXPECT_NEAR(table.largest, (made - Vector3d(0.02, 0.03, 0.01)).norm(), 1e-17);
  EXPECT_NE(table.text.find(",\"a, b\"\n"), std::string::npos);
}

TEST(CorrectedTable, KeepsTheFormOfOtherPrograms) {
  const map::ErrorMap map = map::RandomMap(2);
  const Corrector corrector(map, Vector3d::Zero());
  const auto corrected = [&](const std::string& text) {
    return CorrectTable(text, "t.csv", corrector).text;
  };
  const std::string written = corrected("X [mm];Y [mm];Z [mm];note\n20,5;30,0;10,0;a\n");
  std::string plain = corrected("x_mm,y_mm,z_mm,note\n20.5,30,10,a\n");
  plain = plain.substr(plain.find('\n') + 1);
  std::ranges::replace(plain, ',', ';');
  std::ranges::replace(plain, '.', ',');
  EXPECT_EQ(written, "X [mm];Y [mm];Z [mm];note\n" + plain);

  // One comma tells how the whole table writes its decimals.
  const std::string mixed = corrected("X [mm];Y [mm];Z [mm]\n20;30;10\n20,5;30;10\n");
  EXPECT_EQ(mixed.find('.'), std::string::npos) << mixed;
  EXPECT_EQ(std::ranges::count(mixed, ','), 6) << mixed;

  // Line ends of Windows stay.
  const std::string windows = corrected("# a\r\nx_mm,y_mm,z_mm\r\n20.5,30,10\r\n");
  EXPECT_EQ(std::ranges::count(windows, '\r'), 3);
  EXPECT_TRUE(windows.starts_with("# a\r\nx_mm,y_mm,z_mm\r\n20."));
  EXPECT_TRUE(windows.ends_with("\r\n"));

  const std::string tabs = corrected("\xEF\xBB\xBF\"X (um)\"\ty / mm\tz_m\n20500\t30\t0.01\n");
  const std::string row = tabs.substr(tabs.find('\n') + 1);
  const auto words = map::PartsOf(row, '\t');
  const Vector3d made = corrector.Made({0.0205, 0.03, 0.01});
  EXPECT_NEAR(map::NumberOf(words[0], "x"), 1e6 * made.x(), 1e-9);
  EXPECT_NEAR(map::NumberOf(words[1], "y"), 1e3 * made.y(), 1e-12);
  EXPECT_NEAR(map::NumberOf(words[2], "z"), made.z(), 1e-15);
}

TEST(CorrectedTable, RefusesWithTheLine) {
  const map::ErrorMap map = map::RandomMap(2);
  const Corrector corrector(map, Vector3d::Zero());
  const auto refusal = [&](const char* text) {
    return map::MessageOf<InputError>([&] { CorrectTable(text, "t.csv", corrector); });
  };
  // Within the soft limits, 0.1 mm beyond the travel of 60 mm, no error is known either.
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n1,2,3\n60.09,2,3\n"),
                 "t.csv:3: X = 60.09 mm lies outside its travel, 0 to 60 mm");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n61,2,3\n"), "t.csv:2: X = 61 mm lies outside its travel");
  map::ExpectHas(refusal("x_mm,y_mm\n1,2\n"), "t.csv:1: there is no column z_mm");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n1,2,3\n1,2\n"), "t.csv:3: 2 values");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n1,nan,3\n"), "t.csv:2: \"nan\"");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n1,2,61\n"), "t.csv:2: Z = 61 mm");
  map::ExpectHas(refusal("X,Y,Z\n1,2,3\n"), "t.csv:1: the column X states no unit of length");
  map::ExpectHas(refusal("X [deg],Y [mm],Z [mm]\n1,2,3\n"), "X [deg] states no unit of length");
  map::ExpectHas(refusal("x_mm;y_mm;z_mm\n1,2,3;1;1\n"), "t.csv:2: \"1,2,3\" is not a number");
  map::ExpectHas(refusal("# nothing\n"), "is empty");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n# no row\n"), "t.csv: has no rows under x_mm");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm,x_mm\n1,2,3,4\n"), "t.csv:1: the columns x_mm and x_mm");
  map::ExpectHas(refusal("x_mm,y_mm,X [um],z_mm\n1,2,3,4\n"),
                 "t.csv:1: the columns x_mm and X [um] are all positions of X");
  const std::string utf16("\xFF\xFEx\0_\0m\0m\0\n\0", 12);
  map::ExpectHas(map::MessageOf<InputError>([&] { CorrectTable(utf16, "t.csv", corrector); }),
                 "t.csv:1: is not UTF-8 text; save the table as CSV (UTF-8)");
}

}  // namespace corrected_table_test
}  // namespace abbe::compensation
