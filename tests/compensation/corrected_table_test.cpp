#include "compensation/corrected_table.h"

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
      "# part 7\nname,z_mm,x_mm,y_mm,note\nhole 1,10,20,30,\"a b\"\nhole 2,1e1,20.0,+30,\n",
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
  EXPECT_NE(table.text.find(",\"a b\"\n"), std::string::npos);
}

TEST(CorrectedTable, RefusesWithTheLine) {
  const map::ErrorMap map = map::RandomMap(2);
  const Corrector corrector(map, Vector3d::Zero());
  const auto refusal = [&](const char* text) {
    return map::MessageOf<InputError>([&] { CorrectTable(text, "t.csv", corrector); });
  };
  map::ExpectHas(refusal("x_mm,y_mm\n1,2\n"), "t.csv:1: there is no column z_mm");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n1,2,3\n1,2\n"), "t.csv:3: 2 values");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n1,nan,3\n"), "t.csv:2: \"nan\"");
  map::ExpectHas(refusal("x_mm,y_mm,z_mm\n1,2,61\n"), "t.csv:2: Z = 61 mm");
  map::ExpectHas(refusal("# nothing\n"), "is empty");
}

}  // namespace corrected_table_test
}  // namespace abbe::compensation
