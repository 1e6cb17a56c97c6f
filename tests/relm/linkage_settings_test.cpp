#include "relm/linkage_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"
#include "linkage_by_matrices.h"

namespace abbe::relm {
namespace linkage_settings_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::StartsWith;

void ExpectRefusal(const std::string& text, const std::string& reason) {
  try {
    LinkageFrom(text);
    ADD_FAILURE() << "accepted: " << reason;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
    EXPECT_THAT(error.what(), StartsWith("linkage.toml"));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

constexpr char kBase[] = "[linkage.base]\nposition_mm = [1.0, 2.0, 3.0]\n";

TEST(LinkageSettings, AreReadInSi) {
  const LinkageSettings linkage = LinkageFrom(R"(
[linkage]
form = "pivots"
link_1_mm = 130
link_2_mm = 110
elbow = "down"
reach_over = true
expansion_ppm_per_c = 10
reference_c = 21
temperature = "temp_table_c"
bearing_harmonics = [1, 2, 5]
graduation_harmonics = [4]
[linkage.base]
position_mm = [-180, -30, 15]
rotation = ["y", "-x", "z"]
[linkage.tolerance]
link_um = 1
pivot_urad = 2
pivot_um = 3
encoder_offset_urad = 4
eccentricity_urad = 5
graduation_urad = 6
bearing_um = 7
base_um = 8
base_urad = 9
ball_um = 10
compliance_urad = 11
thermal_ppm_per_c = 12
[linkage.noise]
encoder_urad = 13
reference_um = 14
)");
  EXPECT_EQ(linkage.pivots->link_1(), 0.130);
  EXPECT_EQ(linkage.pivots->link_2(), 0.110);
  EXPECT_EQ(linkage.branch.elbow, Elbow::kDown);
  EXPECT_TRUE(linkage.branch.reach_over);
  EXPECT_DOUBLE_EQ(linkage.expansion, 10e-6);
  EXPECT_EQ(linkage.reference_temperature, 21);
  EXPECT_EQ(linkage.temperature, "temp_table_c");
  EXPECT_EQ(linkage.bearing_harmonics, (std::vector{1, 2, 5}));
  EXPECT_EQ(linkage.graduation_harmonics, (std::vector{4}));
  const LinkageTolerance& sd = linkage.tolerance;
  const std::vector<double> read = {
      sd.link,       sd.pivot_angle, sd.pivot_offset,       sd.encoder_offset,      sd.eccentricity,
      sd.graduation, sd.bearing,     sd.base_position,      sd.base_angle,          sd.ball,
      sd.compliance, sd.thermal,     linkage.noise.encoder, linkage.noise.reference};
  for (std::size_t i = 0; i < read.size(); ++i) EXPECT_DOUBLE_EQ(read[i], 1e-6 * (i + 1.0));
  // The base's x points along machine y, its y along -x: (1, 0, 0) of the base is (0, 1, 0).
  EXPECT_LT((linkage.X_MB * Vector3d(0.1, 0.2, 0.3) - Vector3d(-0.38, 0.07, 0.315)).norm(), 1e-15);
}

TEST(LinkageSettings, KnowWhereDownIsForTheBase) {
  const LinkageSettings hanging = LinkageFrom(
      "[linkage]\ndown = \"-z\"\n[linkage.base]\nposition_mm = [0, 0, 0]\n"
      "rotation = [\"x\", \"-y\", \"-z\"]\n");
  EXPECT_EQ(hanging.DownB(), Vector3d::UnitZ());  // the base hangs upside down
  const LinkageSettings sideways = LinkageFrom(
      "[linkage]\ndown = \"y\"\n[linkage.base]\nposition_mm = [0, 0, 0]\n"
      "rotation = [\"y\", \"-x\", \"z\"]\n");
  EXPECT_EQ(sideways.DownB(), Vector3d::UnitX());
}

// The same linkage in the four forms.
TEST(LinkageSettings, ReadTheSameChainInEveryForm) {
  const std::string base = kBase;
  const std::vector<std::string> texts = {
      "[linkage]\nform = \"pivots\"\nlink_1_mm = 130\nlink_2_mm = 110\n" + base,
      "[linkage]\nform = \"segments\"\n"
      "segment = [{encoder = \"theta\"}, {phi_deg = 90.0}, {length_mm = 130.0, encoder = \"phi\"},"
      " {phi_deg = -90.0}, {length_mm = 110.0, encoder = \"phi\"}]\n" +
          base,
      "[linkage]\nform = \"denavit-hartenberg\"\n"
      "joint = [{alpha_deg = -90.0}, {a_mm = 130.0}, {theta_deg = -90.0},"
      " {a_mm = 110.0, fixed = true}]\n" +
          base,
      "[linkage]\nform = \"denavit-hartenberg\"\nball_mm = [110.0, 0.0, 0.0]\n"
      "joint = [{alpha_deg = -90.0}, {a_mm = 130.0}, {theta_deg = -90.0}]\n" +
          base,
      "[linkage]\nform = \"axes\"\nball_mm = [130.0, 0.0, 110.0]\n"
      "axis = [{point_mm = [0.0, 0.0, 0.0], direction = [0.0, 0.0, 1.0]},"
      " {point_mm = [0.0, 0.0, 0.0], direction = [0.0, 2.0, 0.0]},"
      " {point_mm = [130.0, 0.0, 0.0], direction = [0.0, 1.0, 0.0]}]\n" +
          base};
  const Eigen::VectorXd q = Vector3d(0.4, -0.7, 1.1);
  const Vector3d p = PivotLinkage(0.130, 0.110).Tip(q);
  for (const std::string& text : texts) {
    const LinkageSettings linkage = LinkageFrom(text);
    ASSERT_EQ(linkage.chain.joints(), 3) << text;
    EXPECT_LT((linkage.chain.Tip(q) - p).norm(), 1e-15) << text;
    EXPECT_EQ(linkage.pivots.has_value(), text == texts[0]);
    EXPECT_LT((MakeLinkageModel(linkage, ErrorModel::kComplete)
                   .Tip(q, 0, MakeLinkageModel(linkage, ErrorModel::kComplete).Values()) -
               p)
                  .norm(),
              1e-15)
        << text;
  }
}

TEST(LinkageSettings, RefuseWhatCannotBe) {
  const std::string base = kBase;
  const auto pivots = [&](const std::string& line) {
    return "[linkage]\nform = \"pivots\"\n" + line + "\n" + base;
  };
  ExpectRefusal("[linkage]\nform = \"pivots\"\n", "position_mm");
  ExpectRefusal("[linkage]\nform = \"arms\"\n" + base, "form");
  ExpectRefusal(pivots("link_1_mm = 0"), "link_1_mm");
  ExpectRefusal(pivots("link_2_mm = -3"), "link_2_mm");
  ExpectRefusal(pivots("link_2_mm = nan"), "link_2_mm");
  ExpectRefusal(pivots("elbow = \"left\""), "elbow");
  ExpectRefusal(pivots("link1_mm = 120"), "link_1_mm");  // the nearest known key
  ExpectRefusal(pivots("down = \"south\""), "not a machine direction");
  ExpectRefusal(pivots("down = \"+-z\""), "not a machine direction");
  ExpectRefusal(pivots("bearing_harmonics = [0]"), "whole numbers from 1 to 64");
  ExpectRefusal(pivots("graduation_harmonics = [1.5]"), "whole numbers from 1 to 64");
  ExpectRefusal(pivots("graduation_harmonics = [1e30]"), "whole numbers from 1 to 64");
  ExpectRefusal(pivots("") + "rotation = [\"x\", \"y\", \"-z\"]\n", "right-handed");
  ExpectRefusal(pivots("") + "rotation = [\"x\", \"x\", \"z\"]\n", "right-handed");
  ExpectRefusal(pivots("") + "tilt = 1\n", "tilt");
  ExpectRefusal(pivots("") + "[linkage.tolerance]\nlink_um = -1\n", "link_um");
  ExpectRefusal(pivots("") + "[linkage.tolerance]\nlink_mm = 1\n", "link_um");
  ExpectRefusal(pivots("") + "[linkage.noise]\nencoder_um = 1\n", "encoder_urad");
  ExpectRefusal("[linkage]\nform = \"segments\"\n" + base, "no joint");
  ExpectRefusal("[linkage]\nform = \"segments\"\nsegment = [{encoder = \"psi\"}]\n" + base,
                "encoder");
  ExpectRefusal("[linkage]\nform = \"segments\"\nsegment = [{length_mm = -1.0}]\n" + base,
                "length_mm");
  ExpectRefusal("[linkage]\nform = \"denavit-hartenberg\"\njoint = [{fixed = true}]\n" + base,
                "no joint");
  ExpectRefusal(
      "[linkage]\nform = \"axes\"\nball_mm = [1.0, 0.0, 0.0]\n"
      "axis = [{point_mm = [0.0, 0.0, 0.0], direction = [0.0, 0.0, 0.0]}]\n" +
          base,
      "direction that is not zero");
  ExpectRefusal(
      "[linkage]\nform = \"axes\"\n"
      "axis = [{point_mm = [0.0, 0.0, 0.0], direction = [0.0, 0.0, 1.0]}]\n" +
          base,
      "ball_mm");
}

// The machine carries the workpiece along the axes before b, the tool along those after it.
TEST(NominalTip, GoesAgainstTheAxesThatCarryTheWorkpiece) {
  const Vector3d axes(0.01, 0.02, 0.03);
  EXPECT_EQ(NominalTip(machine::Chain::Parse("[w X Y b Z t]"), axes), Vector3d(-0.01, -0.02, 0.03));
  EXPECT_EQ(NominalTip(machine::Chain::Parse("[w b Y X Z t]"), axes), axes);
  EXPECT_EQ(NominalTip(machine::Chain::Parse("[w Y b X Z t]"), axes), Vector3d(0.01, -0.02, 0.03));
}

}  // namespace linkage_settings_test
}  // namespace abbe::relm
