// A model as a file: what is written is read, and what a person gets wrong is said with its place.
#include "simulation/extended_model.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "failure/failure.h"
#include "recording/instant.h"
#include "simulation/causes/registry.h"
#include "tests/recording/scratch.h"

namespace abbe::simulation {
namespace extended_model_test {

using Eigen::VectorXd;

const CauseObjects kMill{"mill", true, 3};

std::filesystem::path Written(const std::string& text) {
  static const recording::Scratch folder;
  const auto path = folder / "test.toml";
  std::ofstream(path) << text;
  return path;
}

ExtendedModel Read(const std::string& causes) {
  return ReadExtendedModel(Written("extended_model = 1\nmachine = \"mill\"\n" + causes), kMill);
}

void ExpectRefused(const std::string& causes, const std::vector<std::string>& words) {
  try {
    Read(causes);
    ADD_FAILURE() << "read:\n" << causes;
  } catch (const InputError& error) {
    for (const std::string& word : words) EXPECT_THAT(error.what(), testing::HasSubstr(word));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

ExtendedModel SomeModel() {
  ExtendedModel model;
  model.machine = "mill";
  model.origin.started = 1795248000.0;
  model.origin.temperature = {{"temp_table_c", 20.125}};
  model.gain = {120, 1.75, 1.01, 1.6, 1.0};
  model.sources = {{"01_sweep_X.h5", std::string(64, 'a')}};
  const Cause& backlash = CauseNamed("backlash");
  const Cause& cyclic = CauseNamed("leadscrew-cyclic");
  const Cause& growth = CauseNamed("thermal-growth");
  model.causes.push_back({&backlash, "X", VectorXd::Constant(1, 6.1e-6),
                          VectorXd::Constant(1, 5e-8), Eigen::MatrixXd::Constant(1, 1, 6.25e-16)});
  Eigen::MatrixXd covariance(2, 2);
  covariance << 4e-16, 1e-16, 1e-16, 9e-16;
  model.causes.push_back({&cyclic, "Y", Eigen::Vector3d(5e-3, 2e-6, 0.5),
                          Eigen::Vector3d(0.0, 4e-8, 0.02), covariance});
  model.causes.push_back({&growth, "Z temp_table_c", VectorXd::Constant(1, 1e-5), {}, {}});
  model.verdict = kVerdictUnexplained;
  model.next_runs = {"repeat 04_circle_XY at 120 mm/min instead of 600"};
  model.unexplained = {{"probe_a", "time", 0.25, "um", 2.5e-7},
                       {"07_arm", "scatter", 3.5, "times the noise", std::nullopt}};
  model.causes[0].probability = 0.75;
  model.causes[0].rivals = {"servo-lag:X", "reversal-spike:X"};
  return model;
}

TEST(ExtendedModel, IsReadAsItWasWritten) {
  const ExtendedModel model = SomeModel();
  const ExtendedModel read = ReadExtendedModel(Written(ExtendedModelText(model)), kMill);
  EXPECT_EQ(read.origin.started, model.origin.started);
  EXPECT_EQ(read.origin.temperature, model.origin.temperature);
  EXPECT_EQ(read.gain.heldout_rows, 120);
  EXPECT_EQ(read.gain.heldout_after, 1.01);
  ASSERT_EQ(read.sources.size(), 1U);
  EXPECT_EQ(read.sources[0].sha256, model.sources[0].sha256);
  ASSERT_EQ(read.causes.size(), model.causes.size());
  for (std::size_t i = 0; i < read.causes.size(); ++i) {
    const ModelledCause &one = read.causes[i], &other = model.causes[i];
    EXPECT_EQ(one.Name(), other.Name());
    EXPECT_EQ(one.object, other.object);
    EXPECT_LT((one.values - other.values).norm(), 1e-15 * other.values.norm());
    EXPECT_EQ(one.u95.size(), other.u95.size());
    EXPECT_EQ(one.covariance, other.covariance);
  }
  EXPECT_EQ(read.causes[2].Name(), "thermal-growth:Z (temp_table_c)");
}

TEST(ExtendedModel, StatesWhatTheDiagnosisIsNotSureOf) {
  const ExtendedModel model = SomeModel();
  const ExtendedModel read = ReadExtendedModel(Written(ExtendedModelText(model)), kMill);
  EXPECT_EQ(read.verdict, "unexplained");
  EXPECT_EQ(read.next_runs, model.next_runs);
  EXPECT_EQ(read.causes[0].probability, 0.75);
  EXPECT_EQ(read.causes[0].rivals, model.causes[0].rivals);
  ASSERT_EQ(read.unexplained.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.unexplained[i].object, model.unexplained[i].object);
    EXPECT_EQ(read.unexplained[i].variable, model.unexplained[i].variable);
    EXPECT_EQ(read.unexplained[i].amplitude, model.unexplained[i].amplitude);
    EXPECT_EQ(read.unexplained[i].unit, model.unexplained[i].unit);
  }
  EXPECT_DOUBLE_EQ(read.unexplained[0].in_space.value(), 2.5e-7);
  EXPECT_FALSE(read.unexplained[1].in_space);
  EXPECT_EQ(ExtendedModelText(read), ExtendedModelText(model));
}

TEST(ExtendedModel, MayStateNoVerdict) {
  const ExtendedModel read = Read("[[cause]]\nid = \"backlash\"\nobject = \"X\"\nwidth_um = 6.0\n");
  EXPECT_EQ(read.verdict, "");
  EXPECT_EQ(read.causes[0].probability, 1.0);
  EXPECT_TRUE(read.unexplained.empty());
}

TEST(ExtendedModel, ATableThatIsDeletedIsACauseThatIsGone) {
  std::string text = ExtendedModelText(SomeModel());
  const std::size_t first = text.find("[[cause]]");
  text.erase(first, text.find("[[cause]]", first + 1) - first);
  const ExtendedModel read = ReadExtendedModel(Written(text), kMill);
  ASSERT_EQ(read.causes.size(), 2U);
  EXPECT_EQ(read.causes[0].cause->id, "leadscrew-cyclic");
}

TEST(ExtendedModel, HoldsTheCausesOfArms) {
  const ExtendedModel read = Read(
      "[[cause]]\nid = \"joint-gain\"\nobject = \"pivot_2\"\ngain_ppm = 300\n"
      "[[cause]]\nid = \"arm-drift\"\nobject = \"arm\"\nx_um = 1\ny_um = 2\nz_um = 3\n"
      "time_constant_s = 40\n"
      "[[cause]]\nid = \"late-reading\"\nobject = \"arm\"\nshare = 0.9\n"
      "[[cause]]\nid = \"joint-compliance\"\nobject = \"pivot_3\"\nown_urad_per_m = 0\n"
      "wrist_urad_per_m = 0\nball_urad_per_m = 0\ntorque_urad_per_newton_m = 20\n");
  ASSERT_EQ(read.causes.size(), 4U);
  EXPECT_DOUBLE_EQ(read.causes[3].values[3], 20e-6);
  ExpectRefused("[[cause]]\nid = \"joint-gain\"\nobject = \"pivot_9\"\ngain_ppm = 1\n",
                {"pivot_9", "joint-gain"});
}

TEST(ExtendedModel, EveryCauseCanBeWrittenDown) {
  ExtendedModel model;
  model.machine = "mill";
  Trace head, linkage, shaft;
  head.head.emplace();
  head.sensors = {"temp_table_c"};
  linkage.linkage.emplace().angles.resize(3, 1);
  shaft.rim.emplace().sensors = 3;
  const Scene scene{{&head, &linkage, &shaft}, Eigen::Vector3d::Constant(0.06)};
  for (const Cause& cause : Causes()) {
    if (cause.objects(scene).empty()) continue;  // found row by row
    VectorXd values(static_cast<Eigen::Index>(cause.keys.size()));
    for (std::size_t i = 0; i < cause.keys.size(); ++i) {
      const CauseKey& key = cause.keys[i];
      values[static_cast<Eigen::Index>(i)] = key.unit * 0.5 * (key.least + key.most);
    }
    model.causes.push_back({&cause, cause.objects(scene).front(), values, {}, {}});
  }
  const ExtendedModel read = ReadExtendedModel(Written(ExtendedModelText(model)), kMill);
  ASSERT_EQ(read.causes.size(), model.causes.size());
  for (std::size_t i = 0; i < read.causes.size(); ++i) {
    EXPECT_EQ(read.causes[i].cause, model.causes[i].cause) << model.causes[i].cause->id;
    EXPECT_EQ(read.causes[i].object, model.causes[i].object);
  }
}

TEST(ExtendedModel, SaysWhatIsWrongAndWhere) {
  ExpectRefused("[[cause]]\nid = \"backlush\"\nobject = \"X\"\n",
                {"test.toml:4:", "backlush", "the nearest is \"backlash\""});
  ExpectRefused("[[cause]]\nid = \"backlash\"\nobject = \"X\"\nwidth = 6.0\n",
                {"width_um", "is missing"});
  ExpectRefused("[[cause]]\nid = \"backlash\"\nobject = \"X\"\nwidth_um = 6.0\nwidth_umm = 1.0\n",
                {"test.toml:7:", "width_umm", "did you mean \"width_um\""});
  ExpectRefused("[[cause]]\nid = \"backlash\"\nobject = \"X\"\nwidth_um = 9e6\n",
                {"test.toml:6:", "9000000 um", "at most 1000 um"});
  ExpectRefused("[[cause]]\nid = \"backlash\"\nobject = \"X\"\nwidth_um = nan\n",
                {"test.toml:6:", "finite"});
  ExpectRefused("[[cause]]\nid = \"joint-hysteresis\"\nobject = \"pivot_4\"\nwidth_urad = 9.0\n",
                {"test.toml:5:", "machine \"mill\" has no \"pivot_4\"", "nearest is \"pivot_"});
  ExpectRefused("[[cause]]\nid = \"thermal-growth\"\nobject = \"X\"\n", {"sensor"});
  ExpectRefused(
      "[[cause]]\nid = \"backlash\"\nobject = \"X\"\nwidth_um = 6.0\ncovariance = [1.0, 2.0]",
      {"covariance", "1 numbers"});
  ExpectRefused("[diagnosis]\nverdict = \"sure\"\n", {"test.toml:4:", "sure"});
  ExpectRefused("[diagnosis]\nverdict = \"clean\"\nverdicts = 1\n", {"test.toml:5:", "verdict"});
  ExpectRefused("started = \"yesterday\"\n", {"test.toml:3:", "is no time"});
}

TEST(ExtendedModel, OfAnotherMachineOrNoModelAtAllIsRefused) {
  const auto other = Written("extended_model = 1\nmachine = \"lathe\"\n");
  EXPECT_THAT([&] { ReadExtendedModel(other, kMill); },
              testing::ThrowsMessage<InputError>(testing::AllOf(testing::HasSubstr("test.toml:2:"),
                                                                testing::HasSubstr("\"lathe\""),
                                                                testing::HasSubstr("\"mill\""))));
  const auto none = Written("name = \"mill\"\n");
  EXPECT_THAT([&] { ReadExtendedModel(none, kMill); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("is no extended model")));
}

TEST(ExtendedModel, TheLinkageIsNothingToAMachineWithoutOne) {
  const auto path = Written(
      "extended_model = 1\nmachine = \"mill\"\n[[cause]]\nid = \"cap-friction\"\nobject = \"cap\"\n"
      "displacement_um = 1.0\n");
  EXPECT_THAT(
      [&] {
        ReadExtendedModel(path, {"mill", true, 0});
      },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("delete the table")));
}

TEST(Instant, IsWrittenAsItIsRead) {
  EXPECT_EQ(recording::SecondsOf("1970-01-02T00:00:01Z"), 86401.0);
  EXPECT_EQ(recording::InstantText(86401.0), "1970-01-02T00:00:01Z");
  EXPECT_FALSE(recording::SecondsOf("yesterday"));
}

TEST(Instant, HasAZoneAndExists) {
  const double nine = *recording::SecondsOf("2026-11-21T09:00:00Z");
  EXPECT_EQ(recording::SecondsOf("2026-11-21T14:00:00+05:00"), nine);
  EXPECT_EQ(recording::SecondsOf("2026-11-20T23:30:00-09:30"), nine);
  EXPECT_EQ(recording::SecondsOf("2026-11-21 09:00:00"), nine);  // without a zone: UTC
  EXPECT_EQ(recording::SecondsOf("2026-11-21T09:00:00.25Z"), nine + 0.25);
  EXPECT_EQ(recording::SecondsOf("2026-11-21"), nine - 9 * 3600);  // a date alone: its first second
  EXPECT_TRUE(recording::SecondsOf("2028-02-29T00:00:00Z"));
  for (const char* const none :
       {"2026-02-30T00:00:00Z", "2026-02-29T00:00:00Z", "2026-13-01T00:00:00Z",
        "2026-11-21T24:00:00Z", "2026-11-21T09:00:60Z", "2026-11-21T09:60:00Z", "2026-11-31",
        "2026-11-21T09:00:00+5", "2026-11-21T09:00:00+24:00", "2026-11-21T09:00:00 o'clock", "",
        "2026-11-21T09:00:00.Z"}) {
    EXPECT_FALSE(recording::SecondsOf(none)) << none;
  }
}

}  // namespace extended_model_test
}  // namespace abbe::simulation
