#include "map/map_file.h"

#include "failure/failure.h"
#include "map/text_file.h"
#include "map_cases.h"

namespace abbe::map {
namespace map_file_test {

using Eigen::Vector3d;

void ExpectSame(const ErrorMap& a, const ErrorMap& b) {
  EXPECT_EQ(a.origin().machine, b.origin().machine);
  EXPECT_EQ(a.origin().reference, b.origin().reference);
  EXPECT_EQ(a.origin().tool, b.origin().tool);
  EXPECT_EQ(a.origin().temperature, b.origin().temperature);
  EXPECT_EQ(a.Scale(), b.Scale());
  EXPECT_EQ(a.origin().sources, b.origin().sources);
  EXPECT_EQ(a.model().chain().Text(), b.model().chain().Text());
  EXPECT_EQ(a.ParameterNames(), b.ParameterNames());
  EXPECT_EQ(a.model().Parameters(), b.model().Parameters());
  EXPECT_EQ(a.cov_pp(), b.cov_pp());
  for (int i = 0; i < 50; ++i) {
    const Vector3d place = RandomPlace(a, 5, i), tool(0.02, 0.0, -0.1);
    EXPECT_EQ(a.Error(place, tool), b.Error(place, tool));
  }
}

TEST(MapFile, WrittenAndReadItIsTheSameBitForBit) {
  const Folder folder;
  for (const ErrorMap& map : {RandomMap(1), RandomMap(2, kBridge), MapOfAllForms(3)}) {
    WriteMap(map, folder / "a/map.toml");
    const ErrorMap read = ReadMap(folder / "a/map.toml");
    ExpectSame(map, read);
    WriteMap(read, folder / "b.toml");
    EXPECT_EQ(ReadWhole(folder / "a/map.toml"), ReadWhole(folder / "b.toml"));
  }
}

// Which way its axes count, its soft limits, and tables that are taken as they stand.
TEST(MapFile, KeepsTheCountTheLimitsAndTheGauge) {
  const Folder folder;
  machine::Chain chain = machine::Chain::Parse(kColumn);
  chain.ReadPositive("tool carriage tool", "");
  machine::VolumetricModel model(chain, {{{0, 0.1}, {0, 0.1}, {0, 0.1}}});
  model.SetForm(0, 4, machine::MakeTableForm({0, 0.1}), machine::Gauge::kNone);
  model.SetCoefficients(0, 4, Eigen::Vector2d(50e-6, 60e-6));
  MapOrigin origin;
  origin.limits = {{{-0.002, 0.101}, {0, 0.1}, {-0.001, 0.1}}};
  WriteMap({origin, model, {}}, folder / "map.toml");
  const ErrorMap read = ReadMap(folder / "map.toml");
  ExpectSame({origin, model, {}}, read);
  EXPECT_EQ(read.model().chain().PositiveText(), "tool carriage tool");
  EXPECT_EQ(read.model().Function(0, 4).Evaluate(0.0), 50e-6);
  EXPECT_EQ(read.Limits()[0].first, -0.002);
  EXPECT_EQ(read.Limits()[2].last, 0.1);
  EXPECT_EQ(RandomMap(1).Limits()[1].last, 0.06 + machine::kBeyondTravel);
}

// A map with a response, an instrument, a sensor and a walk.
ErrorMap TrackedMap() {
  const ErrorMap map = RandomMap(1);
  const Eigen::Index before = map.cov_pp().rows();
  MapState state{.time = 1795248000.0,
                 .walk = machine::Population{1e-7, 5e-8, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 0.015},
                 .sensors = {{"table", 1800.0, 21.5, 21.25}},
                 .names = {"response table EXX.linear", "probe_gain.a"},
                 .values = Eigen::Vector2d(7e-7, 1.0003),
                 .covariance = Eigen::MatrixXd::Zero(before + 2, before + 2)};
  state.covariance.topLeftCorner(before, before) = map.cov_pp();
  state.covariance.bottomRightCorner(2, 2) << 4e-14, 1e-12, 1e-12, 1e-8;
  state.covariance(before, 3) = state.covariance(3, before) = 1e-17;
  return {map.origin(), map.model(), map.cov_pp(), state};
}

TEST(MapFile, KeepsTheStateBitForBit) {
  const Folder folder;
  const ErrorMap map = TrackedMap();
  WriteMap(map, folder / "map.toml");
  const ErrorMap read = ReadMap(folder / "map.toml");
  ExpectSame(map, read);
  ASSERT_TRUE(read.state());
  EXPECT_EQ(read.state()->time, map.state()->time);
  EXPECT_EQ(read.state()->names, map.state()->names);
  EXPECT_EQ(read.state()->values, map.state()->values);
  EXPECT_EQ(read.state()->covariance, map.state()->covariance);
  EXPECT_EQ(read.state()->sensors.front().lagged, 21.25);
  EXPECT_EQ(read.state()->walk->smoothness, 0.015);
  WriteMap(read, folder / "again.toml");
  EXPECT_EQ(ReadWhole(folder / "map.toml"), ReadWhole(folder / "again.toml"));
  EXPECT_FALSE(RandomMap(1).state());
}

TEST(MapFile, RefusesAStateThatIsNone) {
  const Folder folder;
  WriteMap(TrackedMap(), folder / "map.toml");
  const std::string text = ReadWhole(folder / "map.toml");
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string broken = text;
    const auto at = broken.rfind(from);
    EXPECT_NE(at, std::string::npos) << from;
    WriteWhole(broken.replace(at, from.size(), to), folder / "bad.toml");
    return MessageOf<InputError>([&] { ReadMap(folder / "bad.toml"); });
  };
  ExpectHas(refusal("time = \"2026", "time = \"never"), "time");
  ExpectHas(refusal("names = [\"response table EXX.linear\", ", "names = ["), "values");
  ExpectHas(refusal("rows = [\n", "rows = [ 1.0,\n"), "state.rows");
  ExpectHas(refusal("lag_s = 1800.0", "lag_s = -1.0"), "lag_s");
  ExpectHas(refusal("walk = [", "walk = [ 1.0, "), "walk");
  ExpectHas(refusal("1e-08,\n]", "-1e-08,\n]"), "variance");
}

TEST(MapFile, AMapWithoutUncertaintyStaysOne) {
  const Folder folder;
  const ErrorMap full = RandomMap(1);
  const ErrorMap map(full.origin(), full.model(), {});
  WriteMap(map, folder / "map.toml");
  EXPECT_FALSE(ReadMap(folder / "map.toml").StatesUncertainty());
}

class BrokenMap : public testing::Test {
 protected:
  BrokenMap() {
    WriteMap(RandomMap(1), folder_ / "map.toml");
    text_ = ReadWhole(folder_ / "map.toml");
  }
  std::string Refusal(const std::string& text) {
    WriteWhole(text, folder_ / "bad.toml");
    return MessageOf<InputError>([&] { ReadMap(folder_ / "bad.toml"); });
  }
  std::string With(const std::string& from, const std::string& to) {
    std::string text = text_;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return Refusal(text.replace(at, from.size(), to));
  }
  Folder folder_;
  std::string text_;
};

TEST_F(BrokenMap, IsRefusedWithFileLineAndKey) {
  ExpectHas(With("coefficients = [", "coefficients = [nan, "), "bad.toml:");
  ExpectHas(With("rows = [\n", "rows = [ nan,\n"), "covariance.rows");
  ExpectHas(With("reference = [", "reference = [nan, "), "reference");
  ExpectHas(With("form = \"b-spline\"", "form = \"bspline\""), "not a form of an error function");
  ExpectHas(With("name = \"EYX\"", "name = \"EXX\""), "EXX is given twice");
  ExpectHas(With("name = \"EYX\"", "name = \"EQX\""), "not an error motion");
  ExpectHas(With("from = \"", "from = \"my "), "not a source");
  ExpectHas(With("format = 1", "format = 2"), "another version");
  ExpectHas(With("scale = \"", "scale = \"not "), "scale");
  ExpectHas(With("x = [0.0, 0.06]", "x = [0.06, 0.06]"), "first below the last");
  ExpectHas(With("machine =", "colour = 3\nmachine ="), "colour");
  ExpectHas(With("positive = \"carriage carriage tool\"\n", ""),
            "positive: it is not stated which way X counts");
  ExpectHas(With("\"EXX.c0\", ", ""), "covariance.names");
}

TEST_F(BrokenMap, ANaNInPlaceOfANumberIsNamed) {
  const auto at = text_.find("coefficients = [") + 16;
  std::string text = text_;
  ExpectHas(Refusal(text.replace(at, text.find(',', at) - at, "nan")),
            "coefficients: must be a list of 8 numbers");
}

// A shape of a few letters that would take gigabytes to make.
TEST_F(BrokenMap, AShapeBeyondItsFileIsRefused) {
  const auto with = [&](const std::string& shape) {
    return Refusal(text_.substr(0, text_.find("\n[[error]]")) +
                   "\n[[error]]\nname = \"EYX\"\nfrom = \"prior\"\n" + shape +
                   "coefficients = [1e-6, 0.0]\n");
  };
  ExpectHas(with("form = \"fourier\"\nharmonics = [1.0]\nperiod_m = [6e-10]\n"),
            "form: a Fourier series with 1e+08 waves over the travel");
  ExpectHas(with("form = \"fourier\"\nharmonics = [1.0]\nperiod_m = [1e-300]\n"), "waves over the");
  ExpectHas(with("form = \"network\"\nneurons = [1e6]\ngain_per_m = [1.0]\n"),
            "coefficients: must be a list of 2000000 numbers");
}

// Wherever the file breaks off it is refused: the covariance comes last, and a file without one
// differs from a file that lost it only where the cut falls between the tables.
TEST_F(BrokenMap, ATruncatedFileIsRefused) {
  for (const double part : {0.0, 0.05, 0.2, 0.5, 0.9, 0.999}) {
    const auto size = static_cast<std::size_t>(part * static_cast<double>(text_.size()));
    ExpectHas(Refusal(text_.substr(0, size)), "bad.toml");
  }
}

}  // namespace map_file_test
}  // namespace abbe::map
