// A campaign with something hidden, corrected by a model that a person wrote, against the same
// seed's campaign without it: what instruments say of the machine must be the same. The rig is all
// but free of noise here, the tolerances are a fifth and a tenth of that of a real one: 20 nm of a
// probe, 3 urad of an encoder at the end of 120 mm.
#include "simulation/correction.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "rig/campaign.h"
#include "simulation/kinds.h"
#include "simulation/linkage/linkage_simulation.h"
#include "tests/fusion/rig_campaign.h"
#include "tests/recording/scratch.h"

namespace abbe::simulation {
namespace correction_test {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::uint64_t kSeed = 7;

struct Case {
  const char* hidden;  // of the rig
  const char* keys;    // of the model
  bool in_sweeps, in_paths;
  // Share of the effect that may be left: the linkage is 5 mrad off its nominal geometry.
  double left = 0.006;
};

// The way that the ball takes, or a play, is known from row to row only, 2 degrees of the circle.
constexpr double kRowToRow = 0.04;
// A share of q Delta^2 with q Delta = 0.25 is left that a quotient would take out too.
constexpr double kSquare = 0.1;
// What an axis or a pivot does between two rows may turn it without a trace.
constexpr double kUnseenTurns = 0.1;

void PrintTo(const Case& each, std::ostream* out) { *out << each.hidden; }

const settings::Document& Demo() {
  static const settings::Document document = fusion::CampaignMachine(
      {{"probe_nm = 20.0", "probe_nm = 0.1"},
       {"drift_nm = 30.0", "drift_nm = 0.1"},
       {"encoder_urad = 3.0", "encoder_urad = 0.001"},
       {"\\n.devices.\n", "\n[rig]\nencoder_counts = 1e12\n\n[devices]\n"}});
  return document;
}

std::vector<recording::Recording> Campaign(const std::vector<std::string>& hidden) {
  const rig::CampaignMachine machine = rig::ReadCampaignMachine(Demo().Root());
  rig::HiddenEffects effects;
  for (const auto& text : hidden) effects.push_back(ParseHidden(text, kSeed, machine.sensors));
  return RecordCampaign(machine, kSeed, effects,
                        {.kind = rig::CampaignKind::kStandard, .reduced = true})
      .recordings;
}

const std::vector<recording::Recording>& Clean() {
  static const std::vector<recording::Recording> campaign = Campaign({});
  return campaign;
}

// "backlash:object=X:width_um=6" -> id and object.
ExtendedModel ModelOf(const Case& each) {
  const std::string hidden = each.hidden;
  const std::size_t colon = hidden.find(':'), object = colon + 8;
  const std::size_t end = hidden.find(':', object);
  static const recording::Scratch folder;
  const auto path = folder / "model.toml";
  std::ofstream(path) << fmt::format(
      "extended_model = 1\nmachine = \"demo-mill\"\nstarted = \"{}\"\n"
      "[[start]]\nsensor = \"temp_table_c\"\ntemperature_c = {}\n"
      "[[cause]]\nid = \"{}\"\nobject = \"{}\"\n{}\n",
      Clean().front().HeaderText("started").value(), Clean().front().At("temp_table_c")[0],
      hidden.substr(0, colon), hidden.substr(object, end - object), each.keys);
  return ReadExtendedModel(path, {"demo-mill", true, 3});
}

class Correcting : public testing::TestWithParam<Case> {
 protected:
  const machine::Machine mill_ = machine::ReadMachine(Demo().Root());
  const probes::HeadSettings head_ = probes::ReadHeadSettings(Demo().Root());
  const relm::LinkageSettings linkage_ = relm::ReadLinkageSettings(Demo().Root());
  const LinkageSimulation nominal_{mill_.chain, linkage_,
                                   relm::MakeLinkageModel(linkage_, relm::ErrorModel::kComplete)};

  // What the instrument says of the machine, m: gaps of the probes or of the loop.
  MatrixXd SaidBy(const recording::Recording& recording) const {
    if (recording.Kind() == "linkage") {
      Eigen::Matrix3Xd gap;
      nominal_.Gap(ReadLinkageRun(recording, linkage_), nominal_.Values(), gap);
      return gap;
    }
    MatrixXd gaps(5, static_cast<Index>(recording.rows()));
    for (Index probe = 0; probe < 5; ++probe) {
      const auto column = recording.At(fmt::format("probe_{}_um", "abcde"[probe]));
      for (Index row = 0; row < gaps.cols(); ++row) {
        gaps(probe, row) = 1e-6 * column[static_cast<std::size_t>(row)];
      }
    }
    return gaps;
  }

  // What nine rows of ten are off the clean campaign at most, but for a constant. The others are
  // those where a play is being taken up, which no recording shows.
  double OffClean(const recording::Recording& recording, const recording::Recording& clean) const {
    MatrixXd off = SaidBy(recording) - SaidBy(clean);
    off.colwise() -= off.rowwise().mean().eval();
    Eigen::RowVectorXd each = off.colwise().norm();
    std::sort(each.begin(), each.end());
    return each[each.size() * 9 / 10];
  }
};

TEST_P(Correcting, LeavesTheCampaignWithoutTheCause) {
  const auto hidden = Campaign({GetParam().hidden});
  const ExtendedModel model = ModelOf(GetParam());
  double largest_sweep = 0.0, largest_path = 0.0;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const std::string kind = hidden[i].Kind();
    if (kind != "sweep" && kind != "linkage") continue;
    const auto corrected =
        Correct(hidden[i], model.causes, model.origin, {mill_, head_, {}, {}, linkage_});
    const double before = OffClean(hidden[i], Clean()[i]);
    const double after = OffClean(corrected.recording, Clean()[i]);
    (kind == "sweep" ? largest_sweep : largest_path) =
        std::max(kind == "sweep" ? largest_sweep : largest_path, before);
    EXPECT_LT(after, (kind == "sweep" ? 4e-9 : 36e-9) + GetParam().left * before) << hidden[i].name;
  }
  if (GetParam().in_sweeps) {
    EXPECT_GT(largest_sweep, 40e-9);
  }
  if (GetParam().in_paths) {
    EXPECT_GT(largest_path, 60e-9);
  }
}

// What the axes lost is given back to the positions, whatever instrument stood there.
TEST(CorrectingPoints, TakesADriftOutOfEachKind) {
  constexpr double kDrift = 24e-3, kTimeConstant = 600.0;  // mm, s
  const Case each{"warm-up-drift:object=Y:", "amplitude_um = 24.0\ntime_constant_s = 600.0", true,
                  true};
  const ExtendedModel model = ModelOf(each);
  const machine::Machine mill = machine::ReadMachine(Demo().Root());
  for (const std::string kind : {"reference", "length", "plate"}) {
    recording::Recording recording;
    recording.name = kind;
    recording.header = fmt::format("kind = \"{}\"\nu_probing_um = 0.1\nstarted = \"{}\"\n", kind,
                                   Clean().front().HeaderText("started").value());
    const std::vector<double> x{5.0, 25.0, 25.0, 5.0}, y{5.0, 5.0, 25.0, 25.0};
    recording.columns = {{"time_s", {0.0, 100.0, 400.0, 2000.0}},
                         {"x_mm", x},
                         {"y_mm", y},
                         {"z_mm", std::vector<double>(4, 10.0)},
                         {"flags", {0.0, 0.0, 0.0, 0.0}}};
    if (kind == "reference") recording.columns.push_back({"ref_y_mm", y});
    if (kind == "plate") {
      recording.columns.insert(recording.columns.end(), {{"setup", {1.0, 1.0, 1.0, 1.0}},
                                                         {"hole", {1.0, 2.0, 3.0, 4.0}},
                                                         {"plate_x_mm", x},
                                                         {"plate_y_mm", y}});
    }
    const auto corrected = Correct(recording, model.causes, model.origin,
                                   {mill, probes::ReadHeadSettings(Demo().Root()), {}, {}, {}});
    for (std::size_t row = 0; row < 4; ++row) {
      const double lost = kDrift * (1.0 - std::exp(-recording.At("time_s")[row] / kTimeConstant));
      EXPECT_NEAR(corrected.recording.At("y_mm")[row], y[row] + lost, 1e-9) << kind << row;
      EXPECT_EQ(corrected.recording.At("x_mm")[row], x[row]) << kind << row;
    }
    EXPECT_EQ(corrected.changes.positions.count, 12) << kind;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Causes, Correcting,
    testing::Values(Case{"backlash:object=X:width_um=6", "width_um = 6.0", false, true, kRowToRow},
                    Case{"leadscrew-cyclic:object=Y:pitch_mm=5:amplitude_um=3:phase_rad=1",
                         "pitch_mm = 5.0\namplitude_um = 3.0\nphase_rad = 1.0", false, true},
                    Case{"scale-error:object=Z:gain_ppm=200", "gain_ppm = 200.0", false, true},
                    Case{"thermal-growth:object=X:coefficient_ppm_per_c=99:sensor=temp_table_c",
                         "sensor = \"temp_table_c\"\ncoefficient_ppm_per_c = 99.0", false, true},
                    Case{"warm-up-drift:object=Y:amplitude_um=24:time_constant_s=600",
                         "amplitude_um = 24.0\ntime_constant_s = 600.0", true, true},
                    Case{"warm-up-drift:object=probe_c:amplitude_um=2:time_constant_s=400",
                         "amplitude_um = 2.0\ntime_constant_s = 400.0", true, false},
                    Case{"warm-up-drift:object=pivot_2:amplitude_urad=60:time_constant_s=600",
                         "amplitude_urad = 60.0\ntime_constant_s = 600.0", false, true},
                    Case{"servo-lag:object=X:delay_ms=1.5", "delay_ms = 1.5", false, true},
                    Case{"servo-lag-mismatch:object=XY:delay_ms=1.5", "delay_ms = 1.5", false,
                         true},
                    Case{"reversal-spike:object=Z:height_um=6:decay_mm=1",
                         "height_um = 6.0\ndecay_mm = 1.0", false, true, kUnseenTurns},
                    Case{"load-coupling:object=XY:coefficient_nm_per_mm2=3",
                         "coefficient_nm_per_mm2 = 3.0", false, true},
                    Case{"probe-gain:object=probe_b:delta=0.05", "delta = 0.05", true, false},
                    Case{"probe-nonlinearity:object=probe_a:quadratic_per_mm=9",
                         "quadratic_per_mm = 9.0", true, false, kSquare},
                    Case{"probe-crosstalk:object=probe_a+probe_d:coefficient=0.04",
                         "coefficient = 0.04", true, false},
                    Case{"channel-swap:object=probe_d+probe_e", "", true, false},
                    Case{"channel-sign:object=probe_c", "", true, false},
                    Case{"encoder-eccentricity:object=pivot_1:sin_urad=150:cos_urad=-80",
                         "sin_urad = 150.0\ncos_urad = -80.0", false, true},
                    Case{"encoder-subdivision:object=pivot_2:order=24:sin_urad=20:cos_urad=10",
                         "order = 24\nsin_urad = 20.0\ncos_urad = 10.0", false, true},
                    Case{"bearing-roundness:object=pivot_2:sin2_um=8:cos2_um=4:sin3_um=0:cos3_um=3",
                         "sin2_um = 8.0\ncos2_um = 4.0\nsin3_um = 0.0\ncos3_um = 3.0", false, true},
                    Case{"link-gravity-bend:object=pivot_2:compliance_urad=200",
                         "compliance_urad = 200.0", false, true},
                    Case{"joint-hysteresis:object=pivot_3:width_urad=50", "width_urad = 50.0",
                         false, true, kUnseenTurns},
                    Case{"cap-friction:object=cap:displacement_um=4", "displacement_um = 4.0",
                         false, true, kRowToRow},
                    Case{"clock-skew:object=linkage:delay_ms=4", "delay_ms = 4.0", false, true}));

}  // namespace correction_test
}  // namespace abbe::simulation
