// A real wheel under three gap sensors at 0, 120 and 240 degrees: what its first harmonics say must
// be found without being told. The data set states amplitudes once per turn of 650, 1005 and 905 um
// at 5 rpm, twice 27, 20 and 13, three times 7, 19 and 20. NumPy's lstsq with eight harmonics gives
// the phases once per turn 130.9, 10.6 and -108.8 degrees at 5.0 rpm, 121.5, 0.9 and -118.1
// at 24.8.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "../folders.h"
#include "recording/monitor_log.h"
#include "tests/diagnosis/shaft_world.h"

namespace abbe::diagnosis {
namespace shaft_field_test {

class RealWheel : public testing::Test {
 protected:
  // Skips without the data.
  void Read(const std::vector<std::string>& files) {
    const auto data = FieldData() / "ess-target-wobble";
    for (const std::string& file : files) {
      if (!std::filesystem::exists(data / file)) GTEST_SKIP() << "skipped: field data not found";
      campaign_.Add(recording::ReadMonitorLog(data / file,
                                              {{"shaft_deg", "TARGET_DU:Rotation-PosAct"},
                                               {"gap_1_mm", "TARGET_MUTS_LOGGER:m0s002-AI01"},
                                               {"gap_2_mm", "TARGET_MUTS_LOGGER:m0s002-AI02"},
                                               {"gap_3_mm", "TARGET_MUTS_LOGGER:m0s002-AI03"}},
                                              {0.0, 120.0, 240.0}));
    }
    diagnosis_ = Diagnose(campaign_);
  }

  const Finding* Found(const std::string& name) const {
    const auto found = std::find_if(
        diagnosis_.findings.begin(), diagnosis_.findings.end(),
        [&](const Finding& finding) { return finding.score.candidate.Name() == name; });
    return found == diagnosis_.findings.end() ? nullptr : &*found;
  }

  void ExpectKey(const std::string& name, double truth, double tolerance) const {
    const Finding* finding = Found(name);
    ASSERT_NE(finding, nullptr) << name;
    EXPECT_NEAR(KeysOf(finding->score).values[0], truth, tolerance) << name;
    // Nothing is more probable beside what a real wheel leaves unexplained.
    EXPECT_GE(finding->probability, kBesideUnexplained) << name;
  }

  Campaign campaign_{SetupOfWheel()};
  Diagnosis diagnosis_;
};

// The curve of a sensor turns up to 2 % of its amplitude into higher orders: (q A)^2, with 27 um
// twice per turn q A = 0.08 and more where form hides some.
constexpr double kCurved = 0.02;

TEST_F(RealWheel, IsEccentricUnderUnequalSensors) {
  Read({"test_03.log"});
  if (IsSkipped()) return;
  ASSERT_FALSE(diagnosis_.findings.empty());
  EXPECT_EQ(diagnosis_.findings.front().score.candidate.Name(), "target-eccentricity:shaft");
  ExpectKey("target-eccentricity:shaft", 650e-6, kCurved * 650e-6);
  ExpectKey("sensor-gain:sensor_2", 1005.0 / 650.0 - 1.0, kCurved * 1005.0 / 650.0);
  ExpectKey("sensor-gain:sensor_3", 905.0 / 650.0 - 1.0, kCurved * 905.0 / 650.0);
  // What comes more often per turn, and what is left of it, is said.
  EXPECT_TRUE(Found("shaft-error-motion:shaft") || Found("target-lobing:shaft"));
  EXPECT_EQ(diagnosis_.verdict, Verdict::kUnexplained);
}

// The phases move by 9.4, 9.7 and 9.3 degrees while the speed grows by 119 degrees/s.
TEST_F(RealWheel, HasAnAngleThatComesLate) {
  Read({"test_03.log", "test_10.log", "test_21.log"});
  if (IsSkipped()) return;
  const double kBySensor = 4e-3;  // s: how far the three phases differ, and the speed between
  ExpectKey("clock-skew:shaft", -9.5 / 119.0, kBySensor);
}

}  // namespace shaft_field_test
}  // namespace abbe::diagnosis
