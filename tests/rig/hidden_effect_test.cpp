#include "rig/hidden_effect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "failure/failure.h"
#include "rig/effects/registry.h"
#include "tests/rig/hidden_worlds.h"

namespace abbe::rig {
namespace hidden_effect_test {

std::string Refusal(const std::string& text) {
  try {
    ParseHidden(text, 1, DemoSensors());
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void ExpectHas(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
}

TEST(HiddenEffect, ReadsItsKeysInTheirUnits) {
  const HiddenEffect effect = ParseHidden(
      "leadscrew-cyclic:object=Y:pitch_mm=5:amplitude_um=0.4:phase_rad=-1", 1, DemoSensors());
  EXPECT_EQ(effect.entry->name, "leadscrew-cyclic");
  EXPECT_EQ(effect.places, std::vector<int>{1});
  EXPECT_DOUBLE_EQ(effect.At("pitch_mm"), 5e-3);
  EXPECT_DOUBLE_EQ(effect.At("amplitude_um"), 0.4e-6);
  EXPECT_DOUBLE_EQ(effect.At("phase_rad"), -1.0);
}

// Units that no other part of the rig has.
TEST(HiddenEffect, ConvertsRareUnits) {
  const auto at = [](const char* text, const char* key) {
    return ParseHidden(text, 1, DemoSensors()).At(key);
  };
  EXPECT_DOUBLE_EQ(at("load-coupling:object=XY:coefficient_nm_per_mm2=2", "coefficient_nm_per_mm2"),
                   2e-9 / 1e-6);
  EXPECT_DOUBLE_EQ(at("probe-nonlinearity:object=probe_a:quadratic_per_mm=2", "quadratic_per_mm"),
                   2e3);
  EXPECT_DOUBLE_EQ(at("thermal-growth:object=X:coefficient_ppm_per_c=3", "coefficient_ppm_per_c"),
                   3e-6);
  EXPECT_DOUBLE_EQ(at("servo-lag:object=X:delay_ms=4", "delay_ms"), 4e-3);
}

TEST(HiddenEffect, WarmUpHasTheUnitOfItsObject) {
  EXPECT_TRUE(ParseHidden("warm-up-drift:object=pivot_2", 1, DemoSensors())
                  .values.contains("amplitude_urad"));
  for (const char* object : {"X", "probe_c"}) {
    EXPECT_TRUE(ParseHidden(std::string("warm-up-drift:object=") + object, 1, DemoSensors())
                    .values.contains("amplitude_um"));
  }
}

// Every cause on every kind of object that it has: what is missing is drawn within its bounds, the
// same for one seed and another for another.
TEST(HiddenEffect, DrawsWhatIsMissing) {
  const std::map<ObjectKind, std::string> objects = {
      {kAxisObject, "Z"},        {kPairObject, "XZ"},     {kProbeObject, "probe_d"},
      {kPivotObject, "pivot_3"}, {kLinkObject, "link_2"}, {kProbePairObject, "probe_d+probe_e"},
      {kHeadObject, "head"},     {kCapObject, "cap"},     {kFaceObject, "target_side"},
      {kSourceObject, "linkage"}};
  for (const Effect& entry : EffectCatalogue()) {
    for (const auto& [kind, object] : objects) {
      if ((entry.objects & kind) == 0) continue;
      const std::string text = std::string(entry.name) + ":object=" + object;
      HiddenEffects first{ParseHidden(text, 5, DemoSensors())};
      const HiddenEffect again = ParseHidden(text, 5, DemoSensors());
      const HiddenEffect other = ParseHidden(text, 6, DemoSensors());
      SetInTime(first, {{100.0, 50.0, true, true}}, {0.1, 0.2, 0.3});
      for (const KeyEntry& key : entry.keys) {
        const std::string name(key.name);
        const double value = first[0].values.at(name);
        ASSERT_TRUE(std::isfinite(value)) << text << " " << name;
        if (key.draw == Draw::kInstant || key.draw == Draw::kTurn) {
          EXPECT_TRUE(std::isnan(again.values.at(name))) << text << " " << name;
          continue;
        }
        EXPECT_EQ(value, again.values.at(name));
        const bool is_fixed = key.low == key.high;
        if (key.draw != Draw::kEither && key.draw != Draw::kWhole && !is_fixed) {
          EXPECT_NE(value, other.values.at(name)) << text << " " << name;
        }
        EXPECT_GE(std::abs(value), key.low) << text << " " << name;
        EXPECT_LE(std::abs(value), key.high * (1.0 + 1e-12)) << text << " " << name;
      }
    }
  }
}

TEST(HiddenEffect, ActsSomewhere) {
  for (const Effect& entry : EffectCatalogue()) {
    EXPECT_NE(entry.objects, 0U) << entry.name;
    EXPECT_TRUE(entry.in_world != nullptr || entry.in_linkage != nullptr || entry.in_run != nullptr)
        << entry.name;
  }
}

TEST(HiddenEffect, ChoosesInstantsWhileTheChannelIsRecorded) {
  const std::vector<RecordedTime> times = {
      {0.0, 100.0, true, false}, {130.0, 50.0, false, true}, {210.0, 10.0, true, false}};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    HiddenEffects hidden = Hide({"encoder-count-slip:object=pivot_1",
                                 "outliers:object=probe_a:count=9", "stuck-channel:object=probe_b"},
                                seed);
    SetInTime(hidden, times);
    const double slip = hidden[0].values.at("time_s");
    EXPECT_TRUE(slip >= 135.0 && slip <= 175.0) << slip;
    ASSERT_EQ(hidden[1].instants.size(), 9U);
    for (const double instant : hidden[1].instants) {
      EXPECT_TRUE((instant >= 10.0 && instant <= 90.0) || (instant >= 211.0 && instant <= 219.0));
    }
    EXPECT_LT(hidden[2].values.at("from_s"), hidden[2].values.at("to_s"));
  }
}

TEST(HiddenEffect, RefusesInOneLineWithTheNearestKnown) {
  ExpectHas(Refusal("backlsh:object=X"), "did you mean \"backlash\"");
  ExpectHas(Refusal("backlash"), "has no object");
  ExpectHas(Refusal("backlash:object=probe_a"), "is no object of this cause");
  ExpectHas(Refusal("probe-gain:object=prob_b"), "did you mean \"probe_b\"");
  ExpectHas(Refusal("backlash:object=X:with_um=3"), "did you mean \"width_um\"");
  ExpectHas(Refusal("backlash:object=X:width_um=wide"), "width_um=wide is no number");
  ExpectHas(Refusal("backlash:object=X:width_um"), "is no key=value");
  ExpectHas(Refusal("leadscrew-cyclic:object=X:pitch_mm=0"), "pitch_mm must be above 0");
  ExpectHas(Refusal("encoder-subdivision:object=pivot_1:order=8.5"), "order must be whole");
  ExpectHas(Refusal("thermal-growth:object=X:sensor=temp_colum_c"),
            "did you mean \"temp_column_c\"");
  ExpectHas(Refusal("link-thermal-growth:object=link_1:sensor=temp_column_c"),
            "did you mean \"temp_table_c\"");
}

TEST(HiddenEffect, TruthSaysWhatIsHiddenInItsUnits) {
  const auto truth = TruthOf(Hide({"thermal-growth:object=X:coefficient_ppm_per_c=4",
                                   "unknown-diagonal-ripple:object=XZ:amplitude_um=2"}));
  EXPECT_EQ(truth[0]["cause"], "thermal-growth");
  EXPECT_EQ(truth[0]["object"], "X");
  EXPECT_EQ(truth[0]["parameters"]["coefficient_ppm_per_c"], 4.0);
  EXPECT_EQ(truth[0]["parameters"]["sensor"], "temp_column_c");
  EXPECT_FALSE(truth[0].contains("variable"));
  EXPECT_EQ(truth[1]["parameters"]["amplitude_um"], 2.0);
  EXPECT_EQ(truth[1]["variable"], "x_mm+z_mm");
}

}  // namespace hidden_effect_test
}  // namespace abbe::rig
