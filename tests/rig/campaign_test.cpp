#include "rig/campaign.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "failure/failure.h"
#include "recording/recording_file.h"
#include "tests/rig/hidden_worlds.h"

namespace abbe::rig {
namespace campaign_test {

CampaignMachine Demo() { return ReadCampaignMachine(DemoMill().Root()); }

Campaign Record(CampaignKind kind, const HiddenEffects& hidden = {}, std::uint64_t seed = 7) {
  return RecordCampaign(Demo(), seed, hidden, {.kind = kind, .reduced = true});
}

const recording::Recording& Find(const Campaign& campaign, const std::string& end) {
  for (const recording::Recording& each : campaign.recordings) {
    if (each.name.ends_with(end)) return each;
  }
  throw InputError("no recording " + end);
}

// kind, and for the linkage the course -> how many.
std::map<std::string, int> Kinds(const Campaign& campaign) {
  std::map<std::string, int> kinds;
  for (const recording::Recording& each : campaign.recordings) {
    ++kinds[each.HeaderText("course").value_or(each.Kind())];
  }
  return kinds;
}

TEST(MeasuringCampaign, HasTheRunsOfItsKind) {
  using Counts = std::map<std::string, int>;
  EXPECT_EQ(Kinds(Record(CampaignKind::kMinimal)), (Counts{{"sweep", 3}, {"circle", 1}}));
  EXPECT_EQ(Kinds(Record(CampaignKind::kStandard)),
            (Counts{{"sweep", 3}, {"circle", 6}, {"cube", 1}, {"dwell", 1}, {"length", 1}}));
  const Campaign full = Record(CampaignKind::kFull);
  EXPECT_EQ(Kinds(full), (Counts{{"sweep", 12},
                                 {"circle", 10},
                                 {"cube", 3},
                                 {"dwell", 1},
                                 {"length", 2},
                                 {"gap-steps", 3},
                                 {"square", 1},
                                 {"stepping", 1}}));
  std::set<std::string> names;
  for (const recording::Recording& each : full.recordings) names.insert(each.name);
  EXPECT_EQ(names.size(), full.recordings.size());
}

TEST(MeasuringCampaign, HeadersSayWhatWasMounted) {
  const Campaign full = Record(CampaignKind::kFull);
  const auto text = [&](const char* name, const char* path) {
    return Find(full, name).HeaderText(path).value_or("none");
  };
  EXPECT_EQ(text("sweep_X", "mounting.id"), "first");
  EXPECT_EQ(text("sweep_X", "mounting.head"), "0deg");
  EXPECT_EQ(text("sweep_X", "mounting.target_reversed"), "false");
  EXPECT_EQ(text("sweep_Y_second", "mounting.id"), "second");
  EXPECT_EQ(text("sweep_Y_second", "mounting.target_shift_mm"), "3.0");
  EXPECT_EQ(text("sweep_Y_second", "mounting.target_reversed"), "true");
  EXPECT_EQ(text("sweep_Z_third", "mounting.head"), "180deg");
  EXPECT_EQ(text("gap_steps_Z", "axis"), "Z");
  EXPECT_EQ(text("gap_steps_Z", "mounting.id"), "first");
  EXPECT_EQ(text("circle_XY_20mm_600", "elbow"), "up");
  EXPECT_EQ(text("circle_XY_20mm_600", "axis"), "XY");
  EXPECT_EQ(Find(full, "circle_XY_20mm_600").HeaderNumber("radius_mm"), 20.0);
  EXPECT_EQ(text("circle_XY_20mm_600_other_elbow", "elbow"), "down");
  EXPECT_EQ(text("circle_XY_20mm_600_second_base", "mounting.base"), "second");
  EXPECT_EQ(text("cube", "mounting.base"), "first");
  EXPECT_EQ(text("dwell", "mounting.base"), "first");
  EXPECT_EQ(text("dwell", "mounting.head"), "0deg");
}

// One machine: it stands switched on from the first to the last, and the time goes on.
TEST(MeasuringCampaign, RunsFollowEachOther) {
  std::string before = "2026-11-21T07:59:59Z";
  const Campaign full = Record(CampaignKind::kFull);
  for (const recording::Recording& each : full.recordings) {
    const auto started = each.HeaderText("started");
    ASSERT_TRUE(started) << each.name;
    EXPECT_GT(started->substr(0, 19), before.substr(0, 19)) << each.name;
    before = *started;
    const auto time = each.At("time_s");
    EXPECT_GE(time.front(), 0.0);
    EXPECT_LT(time.front(), 30.0) << each.name;
    // Every run has both temperatures; the repeat is 3 K warmer.
    const double warmer = each.name.ends_with("_warm") ? 3.0 : 0.0;
    for (const char* sensor : {"temp_column_c", "temp_table_c"}) {
      EXPECT_NEAR(each.At(sensor)[0], 20.0 + warmer, 0.6) << each.name;
    }
  }
  EXPECT_EQ(full.recordings.front().HeaderText("started")->substr(0, 19), "2026-11-21T08:00:00");
}

TEST(MeasuringCampaign, TheScheduleHoldsWhatTheRecordingsTake) {
  const Campaign full = Record(CampaignKind::kFull);
  for (std::size_t i = 0; i + 1 < full.recordings.size(); ++i) {
    const auto clock = [&](std::size_t k) {
      const std::string text = *full.recordings[k].HeaderText("started");
      return 3600.0 * std::stod(text.substr(11, 2)) + 60.0 * std::stod(text.substr(14, 2)) +
             std::stod(text.substr(17, 2));
    };
    EXPECT_LT(clock(i) + full.recordings[i].At("time_s").back(), clock(i + 1))
        << full.recordings[i].name;
  }
}

TEST(MeasuringCampaign, IsAFunctionOfSeedAndWhatIsHidden) {
  const auto columns = [](const Campaign& campaign) {
    std::vector<std::vector<double>> all;
    for (const recording::Recording& each : campaign.recordings) {
      for (const recording::Column& column : each.columns) all.push_back(column.values);
    }
    return all;
  };
  const auto first = columns(Record(CampaignKind::kMinimal));
  EXPECT_EQ(first, columns(Record(CampaignKind::kMinimal)));
  EXPECT_NE(first, columns(Record(CampaignKind::kMinimal, {}, 8)));
  EXPECT_NE(first, columns(Record(CampaignKind::kMinimal, Hide({"probe-gain:object=probe_a"}))));
}

// An effect of no size changes nothing, wherever it acts.
TEST(MeasuringCampaign, NeutralEffectsChangeNothing) {
  HiddenEffects neutral =
      Hide({"backlash:object=X:width_um=0",
            "leadscrew-cyclic:object=Y:amplitude_um=0",
            "scale-error:object=Z:gain_ppm=0",
            "squareness:object=XY:angle_urad=0",
            "thermal-growth:object=X:coefficient_ppm_per_c=0",
            "warm-up-drift:object=X:amplitude_um=0",
            "warm-up-drift:object=probe_a:amplitude_um=0",
            "warm-up-drift:object=pivot_1:amplitude_urad=0",
            "servo-lag-mismatch:object=XY:delay_ms=0",
            "servo-lag:object=X:delay_ms=0",
            "reversal-spike:object=X:height_um=0",
            "load-coupling:object=XY:coefficient_nm_per_mm2=0",
            "standing-position:object=X:rms_um=0",
            "vibration:object=Z:amplitude_um=0",
            "probe-gain:object=probe_a:delta=0",
            "probe-nonlinearity:object=probe_b:quadratic_per_mm=0",
            "probe-position:object=probe_a:du_mm=0:dv_mm=0",
            "fixture-misalignment:object=head:roll_urad=0:pitch_urad=0:yaw_urad=0:du_mm=0:ds_mm=0:"
            "dn_mm=0",
            "probe-tilt-response:object=head:electrode_radius_mm=0",
            "probe-crosstalk:object=probe_a+probe_b:coefficient=0",
            "target-form:object=target_top:rms_um=0",
            "mains-pickup:object=probe_a:amplitude_um=0",
            "encoder-eccentricity:object=pivot_1:sin_urad=0:cos_urad=0",
            "encoder-subdivision:object=pivot_2:sin_urad=0:cos_urad=0",
            "encoder-count-slip:object=pivot_3:angle_urad=0",
            "bearing-roundness:object=pivot_1:sin2_um=0:cos2_um=0:sin3_um=0:cos3_um=0",
            "link-thermal-growth:object=link_1:coefficient_ppm_per_c=0",
            "link-gravity-bend:object=pivot_2:compliance_urad=0",
            "joint-hysteresis:object=pivot_1:width_urad=0",
            "cap-friction:object=cap:displacement_um=0",
            "clock-skew:object=linkage:delay_ms=0",
            "clock-skew:object=probes:delay_ms=0"});
  const Campaign plain = Record(CampaignKind::kStandard);
  const Campaign same = Record(CampaignKind::kStandard, neutral);
  for (std::size_t i = 0; i < plain.recordings.size(); ++i) {
    const auto& columns = plain.recordings[i].columns;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto& values = same.recordings[i].columns[k].values;
      ASSERT_EQ(columns[k].values.size(), values.size());
      // A pivot rounds to counts of 1.5 urad: one may fall the other way.
      const double rounding = columns[k].name.ends_with("_rad") ? 1.6e-6 : 2e-9;
      for (std::size_t row = 0; row < values.size(); ++row) {
        ASSERT_NEAR(columns[k].values[row], values[row], rounding)
            << plain.recordings[i].name << " " << columns[k].name << " " << row;
      }
    }
  }
}

TEST(MeasuringCampaign, ChoosesWhenThingsHappen) {
  const Campaign campaign =
      Record(CampaignKind::kStandard,
             Hide({"encoder-count-slip:object=pivot_1", "outliers:object=probe_a:count=12",
                   "unknown-angle-bump:object=pivot_2"}));
  EXPECT_TRUE(std::isfinite(campaign.hidden[0].values.at("time_s")));
  EXPECT_TRUE(std::isfinite(campaign.hidden[2].values.at("centre_rad")));
  const Campaign plain = Record(CampaignKind::kStandard);
  int jumps = 0;
  bool bumped = false;
  for (std::size_t i = 0; i < plain.recordings.size(); ++i) {
    const auto said = campaign.recordings[i].Find("probe_a_um");
    const auto was = plain.recordings[i].Find("probe_a_um");
    for (std::size_t row = 0; said && row < said->size(); ++row) {
      jumps += std::abs((*said)[row] - (*was)[row]) > 0.99 ? 1 : 0;
    }
    const auto angle = campaign.recordings[i].Find("pivot_2_rad");
    const auto turn = plain.recordings[i].Find("pivot_2_rad");
    for (std::size_t row = 0; angle && row < angle->size(); ++row) {
      bumped = bumped || std::abs((*angle)[row] - (*turn)[row]) > 10e-6;
    }
  }
  EXPECT_EQ(jumps, 12);
  EXPECT_TRUE(bumped);
}

TEST(MeasuringCampaign, LeavesOutWhatTheMachineHasNot) {
  CampaignMachine machine = Demo();
  machine.linkage.reset();
  const CampaignPlan plan{.kind = CampaignKind::kStandard, .reduced = true};
  EXPECT_EQ(RecordCampaign(machine, 1, {}, plan).recordings.size(), 4U);
  for (auto& sweep : machine.rig.sweeps) sweep.reset();
  EXPECT_THROW(RecordCampaign(machine, 1, {}, plan), InputError);
}

TEST(MeasuringCampaign, ItsRecordingsReadBack) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "rig_campaign.csv";
  for (const recording::Recording& made : Record(CampaignKind::kFull).recordings) {
    if (made.Kind() == "sweep" && !made.name.ends_with("sweep_X")) continue;
    std::filesystem::remove(path);
    recording::Write(made, path);
    const recording::Recording read = recording::Read(path);
    EXPECT_TRUE(read.warnings.empty()) << made.name;
    EXPECT_EQ(read.rows(), made.rows()) << made.name;
  }
  std::filesystem::remove(path);
}

}  // namespace campaign_test
}  // namespace abbe::rig
