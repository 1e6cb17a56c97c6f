#include "map/exporter.h"

#include <functional>
#include <map>

#include "failure/failure.h"
#include "map/export_axis_comp.h"
#include "map/export_grid.h"
#include "map/export_tables.h"
#include "map/map_file.h"
#include "map/text_file.h"
#include "map_cases.h"

namespace abbe::map {
namespace exporter_test {

using Eigen::Vector3d;

constexpr double kRelative = 1e-13;  // of errors in units of 1e-6: below 100 of them, 4 eps
constexpr double kRounding = 1e-15;  // m: of numbers that go through mm or um, below 0.3 m
constexpr double kErrorRounding =
    1e-20;  // m: two roundings of errors below 20 um, that go through um

ErrorMap Bare(const ErrorMap& map) { return {map.origin(), map.model(), {}}; }

ExportOptions Options(Eigen::Index points) {
  return {{points, points + 1, points + 2}, Vector3d(0.02, -0.01, -0.08)};
}

using ReadGrid = GridFile (*)(const std::filesystem::path&);
const std::map<std::string_view, ReadGrid> kGridReaders = {
    {"csv", ReadCsvGrid}, {"json", ReadJsonGrid}, {"hdf5", ReadHdf5Grid}, {"vtk", ReadVtkGrid}};

TEST(Exporter, EveryGridFormatReadsBackWhatWasWritten) {
  const Folder folder;
  for (const bool has_u95 : {true, false}) {
    const ErrorMap map = has_u95 ? RandomMap(1) : Bare(RandomMap(1));
    const ExportOptions options = Options(4);
    const MapGrid grid = SampleGrid(map, options.tool, options.counts);
    for (const auto& [name, read] : kGridReaders) {
      SCOPED_TRACE(name);
      const auto path = folder / ("deep/map" + std::string(FormatNamed(name).extension));
      const auto files = FormatNamed(name).write(map, options, path);
      ASSERT_EQ(files, Format::Paths{path});
      const GridFile back = read(path);
      EXPECT_EQ(back.header.machine, map.origin().machine);
      EXPECT_EQ(back.header.chain, kColumn);
      EXPECT_EQ(back.header.scale, "calibrated");
      EXPECT_EQ(back.header.temperature, 20.1);
      EXPECT_LT((back.header.tool - options.tool).norm(), kRounding);
      ASSERT_EQ(back.grid.size(), 4 * 5 * 6);
      EXPECT_LT((back.grid.error() - grid.error()).cwiseAbs().maxCoeff(), kErrorRounding);
      ASSERT_EQ(back.grid.u95().size(), grid.u95().size());
      if (has_u95) {
        EXPECT_LT((back.grid.u95() - grid.u95()).cwiseAbs().maxCoeff(), kErrorRounding);
      }
      for (Eigen::Index i = 0; i < grid.size(); ++i) {
        EXPECT_LT((back.grid.Position(i) - grid.Position(i)).norm(), kRounding);
      }
    }
  }
}

using Import = AxisTables (*)(const std::filesystem::path&);
const std::map<std::string_view, Import> kImports = {{"isg", ReadIsg}, {"etalon", ReadEtalon}};

TEST(Exporter, TheTableFormatsGiveTheWholeMapBackAndAgainTheSameFile) {
  const Folder folder;
  for (const ErrorMap& map : {RandomMap(1), MapOfAllForms(2)}) {
    for (const auto& [name, import] : kImports) {
      SCOPED_TRACE(name);
      const Format& format = FormatNamed(name);
      const ExportOptions options = Options(80);
      format.write(map, options, folder / "a.txt");
      const AxisTables tables = import(folder / "a.txt"),
                       expected = Tabulate(map, options.tool, options.counts);
      for (std::size_t i = 0; i < tables.errors.size(); ++i) {
        ASSERT_EQ(tables.errors[i].positions.size(), expected.errors[i].positions.size());
        for (std::size_t j = 0; j < tables.errors[i].values.size(); ++j) {
          EXPECT_NEAR(tables.errors[i].positions[j], expected.errors[i].positions[j], kRounding);
          EXPECT_NEAR(tables.errors[i].values[j], expected.errors[i].values[j], 1e-6 * kRelative);
        }
      }
      EXPECT_LT((tables.squareness - map.model().squareness()).norm(), 1e-20);
      const ErrorMap back = ReadAnyMap(folder / "a.txt");
      EXPECT_EQ(back.model().chain().Text(), map.model().chain().Text());
      EXPECT_FALSE(back.StatesUncertainty());
      const Discrepancy d = Compare(map, options.tool,
                                    [&](const Vector3d& p) { return back.Error(p, options.tool); });
      EXPECT_LT(d.largest, 0.05 * d.error);
      EXPECT_GT(d.largest, 0.0);
    }
  }
}

// A map whose functions are tables at the exported stations is carried without any loss.
TEST(Exporter, ATableMapSurvivesTheTableFormatsExactly) {
  const Folder folder;
  const ErrorMap map = MapOfTables(Tabulate(RandomMap(4), Vector3d::Zero(), {13, 13, 13}));
  ExportOptions options;
  options.counts = {13, 13, 13};
  for (const char* const name : {"isg", "etalon"}) {
    const Export done = ExportMap(map, FormatNamed(name), options, folder / "a.txt");
    EXPECT_LT(done.discrepancy.largest, kRounding) << name;
    EXPECT_GT(done.discrepancy.error, 1e-6);
  }
}

// First order: with tool vector 0 and only position errors, all formats carry the map up to
// interpolation; with straightness too, Sinumerik still does and LinuxCNC does not.
TEST(Exporter, TheAxisFormatsCarryWhatTheySayAndNoMore) {
  const Folder folder;
  for (const char* const chain : {kColumn, kBridge, "[w Y b X Z t]"}) {
    const ErrorMap full = RandomMap(5, chain);
    ExportOptions options;
    options.counts = {101, 101, 101};
    const auto largest = [&](const char* name, bool with_straightness) {
      machine::VolumetricModel model(full.model().chain(), full.model().travels());
      for (int axis = 0; axis < 3; ++axis) {
        for (int motion = 0; motion < 3; ++motion) {
          if (motion != axis && !with_straightness) continue;
          const auto& function = full.model().Function(axis, motion);
          model.SetForm(axis, motion, function.form());
          model.SetCoefficients(axis, motion, function.coefficients());
        }
      }
      return ExportMap({full.origin(), model, {}}, FormatNamed(name), options, folder / name)
          .discrepancy.largest;
    };
    // Chords of 0.6 mm across functions of 2 um with knots each 12 mm, all three axes.
    EXPECT_LT(largest("linuxcnc", false), 50e-9);
    EXPECT_LT(largest("sinumerik", false), 50e-9);
    EXPECT_LT(largest("sinumerik", true), 50e-9);
    EXPECT_GT(largest("linuxcnc", true), 500e-9);
  }
}

// What a format carries of the error by its own words, between stations that are not there.
Vector3d Carried(std::string_view format, const ErrorMap& map, const Vector3d& p) {
  const Vector3d tool = Vector3d::Zero(), middle = Vector3d::Constant(0.030);
  if (format != "linuxcnc" && format != "sinumerik") return map.Error(p, tool);
  Vector3d on_lines = -2.0 * map.Error(middle, tool), own;
  for (int k = 0; k < 3; ++k) {
    Vector3d at = middle;
    at[k] = p[k];
    own[k] = map.Error(at, tool)[k];
    on_lines += map.Error(at, tool);
  }
  return format == "linuxcnc" ? own : on_lines;
}

// By how much straight lines between stations `step` apart may miss a map: step^2 / 8 times the
// second derivative, of each axis.
double ChordsMiss(const ErrorMap& map, double step) {
  constexpr double kStep = 0.2e-3;
  Vector3d most = Vector3d::Zero();
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vector3d p = RandomPlace(map, 9, i).cwiseMax(kStep).cwiseMin(0.060 - kStep);
    for (int k = 0; k < 3; ++k) {
      const Vector3d off = kStep * Vector3d::Unit(k), zero = Vector3d::Zero();
      const Vector3d bent =
          map.Error(p + off, zero) - 2 * map.Error(p, zero) + map.Error(p - off, zero);
      most[k] = std::max(most[k], bent.norm() / (kStep * kStep));
    }
  }
  return most.sum() * step * step / 8;
}

// Where it says that it misses the map most, it misses it by what it does not carry; nowhere more.
TEST(Exporter, EveryFormatStatesHowMuchItDrops) {
  const Folder folder;
  const ErrorMap map = Bare(RandomMap(6));
  const double chords = ChordsMiss(map, 0.060 / 24);
  for (const Format& format : Formats()) {
    SCOPED_TRACE(format.name);
    ExportOptions options;
    options.counts = {25, 25, 25};
    const Export done = ExportMap(map, format, options, folder / format.name);
    const auto dropped = [&](const Vector3d& p) {
      return (map.Error(p, Vector3d::Zero()) - Carried(format.name, map, p)).norm();
    };
    EXPECT_FALSE(format.drops.empty());
    EXPECT_GT(done.discrepancy.largest, 0.0);
    EXPECT_NEAR(done.discrepancy.largest, dropped(done.discrepancy.where), chords);
    double most = 0.0, error = 0.0;
    for (std::uint64_t i = 0; i < 4000; ++i) {
      const Vector3d p = RandomPlace(map, 8, i);
      most = std::max(most, dropped(p));
      error = std::max(error, map.Error(p, Vector3d::Zero()).norm());
    }
    // As many points as were compared, but others.
    EXPECT_NEAR(done.discrepancy.largest, most, chords + 0.1 * most);
    EXPECT_NEAR(done.discrepancy.error, error, 0.1 * error);
    EXPECT_LT(chords, 0.1 * error);
    for (const auto& file : done.files) EXPECT_TRUE(std::filesystem::exists(file));
  }
  ExpectHas(MessageOf<InputError>([] { FormatNamed("cvs"); }), "csv, json");
}

TEST(Exporter, LinuxcncTakes256PointsAndThreeNumbersALine) {
  const Folder folder;
  ExportOptions options;
  options.counts = {257, 10, 10};
  const ErrorMap map = Bare(RandomMap(1));
  ExpectHas(MessageOf<InputError>([&] { WriteLinuxcnc(map, options, folder / "a.comp"); }),
            "takes 2 to 256");
  options.counts = {256, 10, 10};
  const auto files = WriteLinuxcnc(map, options, folder / "a.comp");
  ASSERT_EQ(files.size(), 3);
  EXPECT_EQ(files[0], folder / "a_x.comp");
  EXPECT_EQ(ReadComp(files[0]).positions.size(), 256);
  WriteWhole(ReadWhole(files[0]) + "70 70 70\n", folder / "long.comp");
  ExpectHas(MessageOf<InputError>([&] { ReadComp(folder / "long.comp"); }), "long.comp:257: more");
  WriteWhole("0 0 0\n1 1\n", folder / "two.comp");
  ExpectHas(MessageOf<InputError>([&] { ReadComp(folder / "two.comp"); }), "two.comp:2: 2 numbers");
  WriteWhole("0 0 0\n0 1 1\n", folder / "same.comp");
  ExpectHas(MessageOf<InputError>([&] { ReadComp(folder / "same.comp"); }), "ascend");
}

class BrokenExport : public testing::Test {
 protected:
  template <typename Read>
  std::string Refusal(const std::string& text, const Read& read) {
    std::filesystem::remove(folder_ / "bad.txt");  // of another form, perhaps
    WriteWhole(text, folder_ / "bad.txt");
    return MessageOf<InputError>([&] { read(folder_ / "bad.txt"); });
  }
  std::string Written(const char* format) {
    ExportOptions options;
    options.counts = {3, 3, 3};
    return ReadWhole(
        FormatNamed(format).write(Bare(RandomMap(1)), options, folder_ / format).front());
  }
  Folder folder_;
};

TEST_F(BrokenExport, IsRefusedWithItsLine) {
  ExpectHas(Refusal("X EXX\n0 0 0\n", ReadIsg), "bad.txt:2: 3 numbers under 2 names");
  ExpectHas(Refusal("X EXX\n0 nan\n", ReadIsg), "bad.txt:2: \"nan\" is not a number");
  ExpectHas(Refusal("X EYQ\n", ReadIsg), "\"EYQ\" is none of the 21");
  ExpectHas(Refusal("X Z EXX\n", ReadIsg), "two axes");
  ExpectHas(Refusal("X EXY\n", ReadIsg), "EXY does not belong");
  ExpectHas(Refusal("[EXX]\nGridpoints = {\n0 0\n", ReadEtalon), "cut off");
  ExpectHas(Refusal("[EXX]\nVALUE = 3\n", ReadEtalon), "bad.txt:2: expected Gridpoints");
  ExpectHas(Refusal("[C0Y]\nVALUE = 3\n[C0Y]\n", ReadEtalon), "bad.txt:3: C0Y is given twice");
  ExpectHas(Refusal("[EXX]\nGridpoints = {\n0 0 0\n}\n", ReadEtalon), "bad.txt:3");
}

TEST_F(BrokenExport, ACutOffFileIsRefusedWhereverTheCutIs) {
  const auto chain = machine::Chain::Parse(kColumn);
  const std::vector<std::pair<const char*, std::function<void(const std::filesystem::path&)>>>
      readers = {{"csv", [](const auto& p) { ReadCsvGrid(p); }},
                 {"json", [](const auto& p) { ReadJsonGrid(p); }},
                 {"hdf5", [](const auto& p) { ReadHdf5Grid(p); }},
                 {"vtk", [](const auto& p) { ReadVtkGrid(p); }},
                 {"etalon", [](const auto& p) { ReadAnyMap(p); }},
                 {"isg", [](const auto& p) { ReadAnyMap(p); }},
                 {"sinumerik", [&](const auto& p) { ReadBackSinumerik({p}, chain); }}};
  for (const auto& [format, read] : readers) {
    SCOPED_TRACE(format);
    const std::string text = Written(format);
    for (const double part : {0.0, 0.1, 0.45, 0.8}) {
      const auto size = static_cast<std::size_t>(part * static_cast<double>(text.size()));
      ExpectHas(Refusal(text.substr(0, size), read), "bad.txt");
    }
  }
}

}  // namespace exporter_test
}  // namespace abbe::map
