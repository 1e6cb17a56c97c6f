#include "recording/hole_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace abbe::recording {
namespace hole_table_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class HoleTable : public testing::Test {
 protected:
  HoleTable() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("hole_table_") + test->name() + ".txt");
  }
  ~HoleTable() override { std::filesystem::remove(path_); }

  Recording ReadText(const std::string& text, double u = 0.0) const {
    std::ofstream(path_) << text;
    return ReadHoleTable(path_, u);
  }
  void Refuses(const std::string& text, const std::string& saying) const {
    EXPECT_THAT([&] { ReadText(text); }, ThrowsMessage<InputError>(HasSubstr(saying)));
  }

  std::filesystem::path path_;
};

const std::string kNames = "   Meas X   Meas Y\tNom X   Nom Y   Err X\r\n";

TEST_F(HoleTable, BecomesAPlateOfOneSetup) {
  const Recording plate = ReadText(
      "Plug Plate: 7\r\n\r\n" + kNames + " 1.5 -2.25  1.4 -2.2  .1\r\n\r\n3 4 5 6 7\r\n", 3.0);
  EXPECT_EQ(plate.Kind(), "plate");
  EXPECT_EQ(plate.HeaderText("u_probing_um"), "3");
  EXPECT_THAT(plate.At("x_mm"), ElementsAre(1.5, 3.0));
  EXPECT_THAT(plate.At("y_mm"), ElementsAre(-2.25, 4.0));
  EXPECT_THAT(plate.At("z_mm"), ElementsAre(0.0, 0.0));
  EXPECT_THAT(plate.At("plate_x_mm"), ElementsAre(1.4, 5.0));
  EXPECT_THAT(plate.At("plate_y_mm"), ElementsAre(-2.2, 6.0));
  EXPECT_THAT(plate.At("setup"), ElementsAre(1.0, 1.0));
  EXPECT_THAT(plate.At("hole"), ElementsAre(1.0, 2.0));
}

TEST_F(HoleTable, RefusesWhatIsNone) {
  Refuses("some text\n",
          "has no line of such names; a table of holes has a line of names with Meas X");
  Refuses(kNames, "has no rows");
  Refuses(kNames + "1 2 3 4\n", ".txt:2: has 4 numbers for 5 names");
  Refuses(kNames + "1 2 3 4 5\n1 x 3 4 5\n", ".txt:3: \"x\" is not a number");
}

}  // namespace hole_table_test
}  // namespace abbe::recording
