#include "relm/tip_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "failure/failure.h"
#include "linkage_by_matrices.h"
#include "relm/error_models.h"

namespace abbe::relm {
namespace tip_path_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

recording::Recording FourRows() {
  return {.name = "circle.csv",
          .header = "kind = \"linkage\"\n",
          .columns = {{"pivot_1_rad", {0.1, 0.2, 0.3, 0.4}},
                      {"pivot_2_rad", {-0.1, -0.2, -0.3, -0.4}},
                      {"pivot_3_rad", {0.5, 0.6, 0.7, 0.8}},
                      {"temp_table_c", {20, 21, 22, 23}},
                      {"flags", {0, 0, recording::kStale, 0}}},
          .warnings = {}};
}

LinkageSettings Warm() {
  LinkageSettings settings = TestLinkage();
  settings.temperature = "temp_table_c";
  return settings;
}

TEST(TipPath, IsTheModelInEveryGoodRow) {
  const LinkageSettings settings = Warm();
  const LinkageModel model = CompleteErrorModel(settings);
  const TipPath path = EvaluateTipPath(FourRows(), settings, model, model.Values());
  EXPECT_EQ(path.rows, (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(path.flagged, 1U);
  ASSERT_EQ(path.tips.cols(), 3);
  for (int i = 0; i < 3; ++i) {
    const double t = 0.1 * static_cast<double>(path.rows[i]);
    // Both links are longer by 11.5 ppm per degree above 20 degC.
    const double grown = 1 + 11.5e-6 * 10 * t;
    const Vector3d p =
        PivotLinkage(grown * kLink1, grown * kLink2).Tip({0.1 + t, -0.1 - t, 0.5 + t});
    EXPECT_LT((path.tips.col(i) - p).norm(), 1e-15);
  }
}

TEST(TipPath, TakesALinkageWithoutThermometerToBeAtItsReferenceTemperature) {
  const LinkageSettings settings = TestLinkage();
  EXPECT_EQ(ReadAngles(FourRows(), settings).readings.warmth.size(), 0);
  recording::Recording without = FourRows();
  without.columns.erase(without.columns.begin() + 3);
  EXPECT_EQ(ReadAngles(without, Warm()).readings.warmth.size(), 0);
}

TEST(TipPath, SaysWhatIsWrongWithARecording) {
  struct Bad {
    std::function<void(recording::Recording&)> spoil;
    const char* reason;
  };
  const std::vector<Bad> cases = {
      {[](auto& r) { r.columns[1].name = "pivot_two_rad"; }, "pivot_2_rad"},
      {[](auto& r) { r.columns[0].values[1] = std::nan(""); }, "row 2: pivot_1_rad is no number"},
      {[](auto& r) { r.columns[3].values[3] = HUGE_VAL; }, "row 4: temp_table_c is no number"},
      {[](auto& r) {
         r.columns[4].values = {1, 1, 1, 1};
       },
       "all 4 rows are flagged"},
      {[](auto& r) { r.columns[2].values[3] += 6.28; }, "row 4: pivot_3_rad jumps by 6.48"},
      {[](auto& r) {
         r.columns.push_back({"pivot_4_rad", {0, 0, 0, 0}});
       },
       "has 3 pivots"},
  };
  for (const Bad& bad : cases) {
    recording::Recording recording = FourRows();
    bad.spoil(recording);
    try {
      ReadAngles(recording, Warm());
      ADD_FAILURE() << "accepted: " << bad.reason;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("circle.csv"));
      EXPECT_THAT(error.what(), HasSubstr(bad.reason));
    }
  }
}

TEST(TipPath, IgnoresWhatAFlaggedRowHolds) {
  recording::Recording recording = FourRows();
  recording.columns[0].values[2] = std::nan("");
  recording.columns[1].values[2] = 1e9;
  EXPECT_EQ(ReadAngles(recording, Warm()).rows.size(), 3U);
}

TEST(InFrame, CarriesEveryColumn) {
  geometry::Transform<double> X_MB;
  X_MB.R = geometry::RotationZ(M_PI / 2);
  X_MB.p = {1, 2, 3};
  Eigen::Matrix3Xd p_BT(3, 2);
  p_BT << 1, 0, 0, 1, 0, 5;  // (1, 0, 0) and (0, 1, 5)
  Eigen::Matrix3Xd p_MT(3, 2);
  p_MT << 1, 0, 3, 2, 3, 8;
  EXPECT_LT((InFrame(X_MB, p_BT) - p_MT).norm(), 1e-15);
}

}  // namespace tip_path_test
}  // namespace abbe::relm
