// What the files of other programs and controls mean, by readers that are written apart from their
// writers, and what is left of a table that others wrote.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "failure/failure.h"
#include "foreign_reader.h"
#include "map/export_axis_comp.h"
#include "map/export_tables.h"
#include "map/exporter.h"
#include "map/text_file.h"
#include "map_cases.h"

namespace abbe::map {
namespace table_meaning_test {

using Eigen::Vector3d;
using machine::Positive;

const std::array<std::array<Positive, 3>, 3> kCounts = {
    {{Positive::kTool, Positive::kTool, Positive::kTool},
     {Positive::kCarriage, Positive::kCarriage, Positive::kCarriage},
     {Positive::kTool, Positive::kCarriage, Positive::kTool}}};
constexpr std::array kChains = {kColumn, kBridge, "[w Y b X Z t]", "[w Z X b Y t]",
                                "[w X Y Z b t]"};

// Any tool, also one that the file was not written for. The chords of 0.1 mm across functions of
// 2 um and 20 urad with knots each 12 mm, with arms of 0.4 m: 5 nm. A sign that is wrong: 10 um.
TEST(TableMeaning, AControlThatReadsTheLineOfTheSignFindsTheMapsError) {
  const Folder folder;
  std::uint64_t seed = 20;
  for (const char* const chain : kChains) {
    for (const auto& positive : kCounts) {
      const ErrorMap map = Counted(RandomMap(++seed, chain), positive);
      for (const char* const format : {"isg", "etalon"}) {
        SCOPED_TRACE(std::string(format) + " " + chain + " " + map.model().chain().PositiveText());
        ExportOptions options;
        options.counts = {601, 601, 601};
        FormatNamed(format).write(map, options, folder / "a.txt");
        const ForeignTables control(ReadWhole(folder / "a.txt"));
        double largest = 0.0;
        for (std::uint64_t i = 0; i < 40; ++i) {
          const Vector3d place = RandomPlace(map, seed, i);
          const Vector3d tool = i % 2 == 0 ? Vector3d(0.05, -0.1, -0.4) : Vector3d::Zero();
          const Vector3d error = map.Error(place, tool);
          largest = std::max(largest, error.norm());
          EXPECT_LT((control.ErrorAt(place, tool) - error).norm(), 5e-9);
        }
        EXPECT_GT(largest, 3e-6);
      }
    }
  }
}

// Counted after ISO 841 every number in the file is one of the tool against the workpiece.
TEST(TableMeaning, CountedAsTheToolGoesPlusIsTheToolTowardsPlus) {
  const Folder folder;
  const ErrorMap map = Counted(RandomMap(5), kCounts[0]);
  ExportOptions options;
  FormatNamed("etalon").write(map, options, folder / "a.etalon");
  const ForeignTables file(ReadWhole(folder / "a.etalon"));
  ASSERT_EQ(file.sign().size(), 3u);
  EXPECT_NE(file.sign()[2].find("the tool is displaced towards + in the workpiece"),
            std::string::npos);
  // At the origin of the other axes the arms are those of X alone, and the tool is in its origin.
  const Vector3d place(0.02, 0.0, 0.0);
  const Vector3d error = map.Error(place, Vector3d::Zero());
  EXPECT_NEAR(file.Value("EXX", 0.02), error.x(), 1e-12);
  EXPECT_NEAR(file.Value("EYX", 0.02), error.y(), 1e-12);
  EXPECT_NEAR(file.Value("EZX", 0.02), error.z(), 1e-12);
  EXPECT_GT(error.cwiseAbs().minCoeff(), 1e-7);

  const ErrorMap by_carriage = Counted(RandomMap(5), kCounts[1]);
  FormatNamed("etalon").write(by_carriage, options, folder / "a.etalon");
  const ForeignTables table(ReadWhole(folder / "a.etalon"));
  ASSERT_EQ(table.sign().size(), 4u);
  EXPECT_NE(table.sign()[2].find("X carries the workpiece and counts as its carriage goes"),
            std::string::npos);
  // Turns of 20 urad and their squareness times 20 mm: 1e-11.
  EXPECT_NEAR(table.Value("EXX", 0.02), -by_carriage.Error(place, Vector3d::Zero()).x(), 1e-11);
}

// A control with CEC adds the tables to its command; one with LinuxCNC's .comp moves the motor by
// nominal - actual. Either way the tool then stands where it should: with displacements only, which
// these formats carry, up to their chords and the error's own slope.
TEST(TableMeaning, AControlThatAddsTheTablesPutsTheToolInItsPlace) {
  const Folder folder;
  std::uint64_t seed = 40;
  for (const char* const chain : kChains) {
    for (const auto& positive : kCounts) {
      const ErrorMap full = Counted(RandomMap(++seed, chain), positive);
      machine::VolumetricModel model(full.model().chain(), full.model().travels());
      for (int axis = 0; axis < 3; ++axis) {
        for (int motion = 0; motion < 3; ++motion) {
          const auto& function = full.model().Function(axis, motion);
          model.SetForm(axis, motion, function.form());
          model.SetCoefficients(axis, motion, function.coefficients());
        }
      }
      const ErrorMap map(full.origin(), model, {});
      SCOPED_TRACE(std::string(chain) + " " + map.model().chain().PositiveText());
      ExportOptions options;
      options.counts = {121, 121, 121};
      FormatNamed("sinumerik").write(map, options, folder / "a.ini");
      std::map<std::pair<int, int>, double> cec;  // table, point: mm
      std::istringstream lines(ReadWhole(folder / "a.ini"));
      for (std::string line; std::getline(lines, line);) {
        int table = 0, point = 0;
        double value = 0.0;
        if (std::sscanf(line.c_str(), "$AN_CEC[%d,%d]=%lf", &table, &point, &value) == 3) {
          cec[{table, point}] = value;
        }
      }
      ASSERT_EQ(cec.size(), 9u * 121u);
      const Vector3d zero = Vector3d::Zero();
      for (const int i : {12, 60, 103}) {
        const Eigen::Vector3i at(i, 120 - i, (i * 7) % 121);
        const Vector3d command = 0.5e-3 * at.cast<double>();
        Vector3d moved = command;
        for (int table = 0; table < 9; ++table)
          moved[table % 3] += 1e-3 * cec[{table, at[table / 3]}];
        const auto place = [&](const Vector3d& axes) -> Vector3d {
          return machine::NominalToolInWork<double>(map.model().chain(), axes, zero);
        };
        const Vector3d stands = place(moved) + map.Error(moved, zero);
        EXPECT_LT((stands - place(command)).norm(), 20e-9);
        EXPECT_GT(map.Error(command, zero).norm(), 200e-9);
      }
    }
  }
}

// One error with a value other than zero at the first end of the travel, one with a slope, a zero
// in the middle of the travel: a table of others is taken as it stands.
TEST(TableMeaning, AForeignTableKeepsItsConstantsAndSlopes) {
  const Folder folder;
  const std::string rest = "Y EYY\n-3000 0\n3000 0\n#\nZ EZZ\n0 0\n1000 0\n";
  WriteWhole("X EBX\n-3000 5e-5\n3000 5e-5\n#\n" + rest, folder / "constant.csv");
  const ErrorMap constant = ReadAnyMap(folder / "constant.csv", "[w b X Y Z t]");
  // 50 urad at an arm of 400 mm.
  EXPECT_NEAR(constant.Error({0.0, 0.0, 0.4}, Vector3d::Zero()).x(), 20e-6, 1e-12);
  EXPECT_NEAR(constant.Error({0.0, 0.0, 0.0}, {0.0, 0.0, -0.1}).x(), -5e-6, 1e-12);

  WriteWhole("X EXX EBX\n-3000 -0.169 -4e-5\n0 0 0\n3000 0.17 2e-5\n#\n" + rest,
             folder / "zero.csv");
  const ErrorMap zero = ReadAnyMap(folder / "zero.csv", "[w X Y b Z t]", "tool");
  EXPECT_EQ(zero.Error(Vector3d::Zero(), {0.3, -0.2, 0.5}).norm(), 0.0);
  // A turn of 40 urad shortens 3 m by 2.4 nm.
  EXPECT_NEAR(zero.Error({-3.0, 0.0, 0.0}, Vector3d::Zero()).x(), -169e-6, 2.5e-9);
  EXPECT_NEAR(zero.Error({3.0, 0.0, 0.0}, Vector3d::Zero()).x(), 170e-6, 2.5e-9);
}

// Random tables, constants and slopes in all, over travels with their zero anywhere: what abbe
// reads is what the file says, for any tool, and what it writes again says the same.
TEST(TableMeaning, ReadingAndWritingLeavesTheVolumetricErrorAsItWas) {
  const Folder folder;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const random::CounterRandom random(seed, 7);
    std::uint64_t drawn = 0;
    const auto next = [&](double size) { return random.Uniform(drawn++, -size, size); };
    const char* const chain = kChains[seed % kChains.size()];
    std::string text =
        std::string("// chain = ") + chain + "\n// positive = carriage carriage carriage\n";
    std::array<std::pair<double, double>, 3> travels;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Whole millimetres, so that the stations written again are the same numbers.
      const double first = std::round(next(3000.0)), length = 8 * std::round(125.0 + next(110.0));
      travels[axis] = {1e-3 * first, 1e-3 * (first + length)};
      text += "XYZ"[axis];
      for (int motion = 0; motion < 6; ++motion)
        text.append(" ").append(machine::MotionName(static_cast<int>(axis), motion));
      for (int i = 0; i <= 8; ++i) {
        text.append("\n").append(std::to_string(first + length * i / 8));
        for (int motion = 0; motion < 6; ++motion) {
          text.append(" ").append(std::to_string(motion < 3 ? next(0.2) : next(5e-4)));
        }
      }
      text += "\n#\n";
    }
    text += "C0Y B0Z A0Z\n" + std::to_string(next(3e-4)) + " " + std::to_string(next(3e-4)) + " " +
            std::to_string(next(3e-4)) + "\n";
    WriteWhole(text, folder / "foreign.csv");
    const ForeignTables file(text);
    const ErrorMap read = ReadAnyMap(folder / "foreign.csv");
    ExportOptions options;
    options.counts = {9, 9, 9};
    options.tool = {next(0.3), next(0.3), next(0.3)};
    for (const char* const format : {"isg", "etalon"}) {
      FormatNamed(format).write(read, options, folder / "again.txt");
      const ForeignTables again(ReadWhole(folder / "again.txt"));
      for (int i = 0; i < 10; ++i) {
        Vector3d place, tool(next(0.5), next(0.5), next(0.5));
        for (Eigen::Index k = 0; k < 3; ++k) {
          const auto [first, last] = travels[static_cast<std::size_t>(k)];
          place[k] = first + (last - first) * (0.5 + next(0.499));
        }
        const Vector3d error = file.ErrorAt(place, tool);
        EXPECT_LT((read.Error(place, tool) - error).norm(), 1e-12) << chain;
        EXPECT_LT((again.ErrorAt(place, tool) - error).norm(), 1e-12);
        EXPECT_GT(error.norm(), 1e-6);
      }
    }
  }
}

// A foreign file does not say how a table counts, and nobody guesses.
TEST(TableMeaning, AsksForTheChainAndTheCount) {
  const Folder folder;
  WriteWhole("X EXX\n0 0\n50 1\n#\nY EYY\n0 0\n50 1\n#\nZ EZZ\n0 0\n50 1\n", folder / "f.csv");
  ExpectHas(MessageOf<InputError>([&] { ReadAnyMap(folder / "f.csv"); }), "--chain");
  // A map that states them is not contradicted, whichever kind it is.
  const ErrorMap own = RandomMap(3, kColumn);
  WriteMap(own, folder / "own.toml");
  ExportMap(own, FormatNamed("isg"), {{5, 5, 5}}, folder / "own.csv");
  const std::string counts = own.model().chain().PositiveText();
  const std::string other = counts.starts_with("tool") ? "carriage" : "tool";
  for (const char* const name : {"own.toml", "own.csv"}) {
    const auto refusal = [&](const char* chain, const std::string& positive) {
      return MessageOf<InputError>([&] { ReadAnyMap(folder / name, chain, positive); });
    };
    EXPECT_EQ(ReadAnyMap(folder / name, kColumn, counts).model().chain().PositiveText(), counts);
    ExpectHas(refusal(kBridge, ""), "but --chain says");
    ExpectHas(refusal("", other), "but --positive says");
  }
  const auto refused = [&](const char* positive) {
    return MessageOf<InputError>([&] { ReadAnyMap(folder / "f.csv", kColumn, positive); });
  };
  ExpectHas(refused(""), "it is not stated which way X counts");
  ExpectHas(refused(""), "--positive");
  ExpectHas(refused("table"), "\"table\" is not a way to count an axis");
  ExpectHas(refused("tool tool"), "one each for X, Y and Z");
  EXPECT_EQ(
      ReadAnyMap(folder / "f.csv", kColumn, "tool carriage tool").model().chain().PositiveText(),
      "tool carriage tool");
  EXPECT_EQ(ReadAnyMap(folder / "f.csv", kBridge).model().chain().PositiveText(), "tool tool tool");
}

}  // namespace table_meaning_test
}  // namespace abbe::map
