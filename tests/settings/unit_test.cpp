#include "settings/unit.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string_view>
#include <utility>

namespace abbe::settings {
namespace unit_test {

void ExpectUnit(std::string_view key, std::string_view name, double si) {
  EXPECT_EQ(UnitOf(key).name, name) << key;
  EXPECT_DOUBLE_EQ(UnitOf(key).si, si) << key;
}

TEST(UnitTest, ReadsTheEndOfAName) {
  ExpectUnit("x_mm", "mm", 1e-3);
  ExpectUnit("probe_a_um", "um", 1e-6);
  ExpectUnit("form_nm", "nm", 1e-9);
  ExpectUnit("pivot_1_rad", "rad", 1.0);
  ExpectUnit("pitch_urad", "urad", 1e-6);
  ExpectUnit("tilt_mrad", "mrad", 1e-3);
  ExpectUnit("angle_deg", "deg", std::numbers::pi / 180.0);
  ExpectUnit("scale_ppm", "ppm", 1e-6);
  ExpectUnit("time_s", "s", 1.0);
  ExpectUnit("stale_ms", "ms", 1e-3);
  ExpectUnit("skew_us", "us", 1e-6);
  ExpectUnit("warm_up_min", "min", 60.0);
  ExpectUnit("rate_hz", "Hz", 1.0);
  ExpectUnit("temp_column_c", "degC", 1.0);
  ExpectUnit("cap_force_n", "N", 1.0);
  ExpectUnit("supply_v", "V", 1.0);
}

TEST(UnitTest, ReadsWhatTablesWrite) {
  for (const auto& [text, key] : {std::pair{"mm", "x_mm"},
                                  {"\u00b5m", "gap_um"},
                                  {"\u03bcrad", "yaw_urad"},
                                  {"\u00b0", "angle_deg"},
                                  {"\u00b0C", "temp_c"},
                                  {"mm/min", "feed_mm_min"},
                                  {"m/min", "feed_m_min"},
                                  {"in", "x_inch"},
                                  {"sec", "time_s"}}) {
    EXPECT_EQ(WrittenUnit(text).name, UnitOf(key).name) << text;
    EXPECT_EQ(WrittenUnit(text).si, UnitOf(key).si) << text;
  }
  EXPECT_DOUBLE_EQ(WrittenUnit("inch").si, 25.4e-3);
  EXPECT_EQ(WrittenUnit("counts").name, "");
}

TEST(UnitTest, KnowsWhatCanBeConverted) {
  EXPECT_TRUE(MeasureTheSame(UnitOf("x_mm"), WrittenUnit("inch")));
  EXPECT_TRUE(MeasureTheSame(UnitOf("t_s"), UnitOf("t_min")));
  EXPECT_TRUE(MeasureTheSame(UnitOf("temp_c"), WrittenUnit("\u00b0C")));
  EXPECT_FALSE(MeasureTheSame(UnitOf("angle_deg"), UnitOf("x_mm")));
  EXPECT_FALSE(MeasureTheSame(UnitOf("temp_c"), UnitOf("gap_um")));
  EXPECT_FALSE(MeasureTheSame(UnitOf("x_m"), UnitOf("feed_m_min")));
}

TEST(UnitTest, TakesTheLongestEnd) {
  ExpectUnit("feed_mm_min", "mm/min", 1e-3 / 60.0);  // not minutes
  ExpectUnit("speed_mm_s", "mm/s", 1e-3);            // not seconds
  ExpectUnit("growth_ppm_per_c", "ppm/degC", 1e-6);  // not degC
  ExpectUnit("drift_um_per_c", "um/degC", 1e-6);
  ExpectUnit("bend_nm_per_mm2", "nm/mm^2", 1e-9 / 1e-6);
  ExpectUnit("gain_per_mm", "1/mm", 1e3);  // not mm
}

TEST(UnitTest, LetsAPlainNumberBe) {
  ExpectUnit("passes", "", 1.0);
  ExpectUnit("direction", "", 1.0);
  ExpectUnit("mm", "", 1.0);  // a unit is an end, not a whole name
  ExpectUnit("", "", 1.0);
  ExpectUnit("xmm", "", 1.0);
}

TEST(UnitTest, TheStemIsWhatIsLeft) {
  EXPECT_EQ(StemOf("time_constant_s"), "time_constant");
  EXPECT_EQ(StemOf("electrode_radius_mm"), "electrode_radius");
  EXPECT_EQ(StemOf("feed_mm_min"), "feed");
  EXPECT_EQ(StemOf("coefficient_ppm_per_c"), "coefficient");
  EXPECT_EQ(StemOf("delta"), "delta");
  EXPECT_EQ(StemOf("probe_gain"), "probe_gain");
}

}  // namespace unit_test
}  // namespace abbe::settings
