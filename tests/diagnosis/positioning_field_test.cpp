// Positioning tests of real axes (ISO 230-2): what is known to be there must be found without being
// told. The data set states of b02 x a mean reversal of -25 um, so a backlash of 25; of week 42 x
// at 8 A a drift of 0, 41, 50, 73, 90 um from cycle to cycle.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "../folders.h"
#include "diagnosis/diagnose.h"
#include "recording/target_table.h"
#include "settings/document.h"

namespace abbe::diagnosis {
namespace positioning_field_test {

// A stage without guide to its quality: positioning errors of some ten um that change from target
// to target.
constexpr const char* kStage = R"(
name = "target-stage"
chain = "[w X Y b Z t]"
[axis.X]
travel_mm = [-25.0, 25.0]
positive = "carriage"
[axis.Y]
travel_mm = [-25.0, 25.0]
positive = "carriage"
[axis.Z]
travel_mm = [-25.0, 25.0]
[population]
positioning_um = 40.0
straightness_um = 10.0
roll_urad = 100.0
pitch_urad = 100.0
yaw_urad = 100.0
squareness_urad = 500.0
scale_ppm = 1000.0
smoothness_mm = 3.0
)";

class RealAxis : public testing::Test {
 protected:
  // Skips without the data.
  void Read(const std::string& file) {
    const auto path = FieldData() / "ess-target-iso230" / file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "skipped: field data not found";
    campaign_.Add(recording::ReadTargetTable(path));
    diagnosis_ = Diagnose(campaign_);
    Print();
  }

  // As in docs/results.md.
  void Print() const {
    fmt::print("{}, chi-square {:.2f} to {:.2f}\n", Name(diagnosis_.verdict), diagnosis_.chi_before,
               diagnosis_.chi_after);
    for (const Finding& finding : diagnosis_.findings) {
      const auto [values, u] = KeysOf(finding.score);
      fmt::print("{} {:.3f}", finding.score.candidate.Name(), finding.probability);
      for (Eigen::Index i = 0; i < values.size(); ++i) {
        const auto& key = finding.score.candidate.cause->keys[static_cast<std::size_t>(i)];
        fmt::print(" {} {:.3g} +- {:.2g}", key.name, values[i] / key.unit, 2.0 * u[i] / key.unit);
      }
      fmt::print("\n");
    }
    for (const Leftover& left : diagnosis_.leftovers) {
      fmt::print("left over {} of {}: {:.2g} um\n", left.variable, left.object,
                 1e6 * left.amplitude);
    }
  }

  const Finding* Found(const std::string& name) const {
    const auto found = std::find_if(
        diagnosis_.findings.begin(), diagnosis_.findings.end(),
        [&](const Finding& finding) { return finding.score.candidate.Name() == name; });
    return found == diagnosis_.findings.end() ? nullptr : &*found;
  }

  Campaign campaign_{simulation::Instruments{
      machine::ReadMachine(settings::Document::Parse(kStage, "stage.toml").Root()),
      std::nullopt,
      {},
      {},
      std::nullopt}};
  Diagnosis diagnosis_;
};

TEST_F(RealAxis, LosesWhatItsMeanReversalSays) {
  Read("b02_target_x.dat");
  if (IsSkipped()) return;
  ASSERT_FALSE(diagnosis_.findings.empty());
  EXPECT_EQ(diagnosis_.findings.front().score.candidate.Name(), "backlash:X");
  const Finding* backlash = Found("backlash:X");
  ASSERT_NE(backlash, nullptr);
  const auto [values, u] = KeysOf(backlash->score);
  EXPECT_NEAR(values[0], 25.4e-6, 3.9 * u[0]);
  EXPECT_LT(u[0], 1e-6);
}

// The motor warms the axis by some 90 um, not along one exponential.
TEST_F(RealAxis, ChangesInTimeWithItsMotor) {
  Read("muts_w42_back_target_x_8A.dat");
  if (IsSkipped()) return;
  EXPECT_EQ(diagnosis_.verdict, Verdict::kUnexplained);
  ASSERT_FALSE(diagnosis_.leftovers.empty());
  const Leftover& left = diagnosis_.leftovers.front();
  EXPECT_EQ(left.object, "X");
  EXPECT_EQ(left.variable, "time");
  EXPECT_GT(left.amplitude, 20e-6);
  EXPECT_LT(left.amplitude, 90e-6);
  for (const Finding& finding : diagnosis_.findings) EXPECT_LT(finding.probability, kCertain);
}

}  // namespace positioning_field_test
}  // namespace abbe::diagnosis
