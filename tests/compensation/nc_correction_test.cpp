#include "compensation/nc_correction.h"

#include <cmath>
#include <numbers>

#include "compensation/corrected_table.h"
#include "compensation/nc_block.h"
#include "failure/failure.h"
#include "map/words.h"
#include "map_cases.h"

namespace abbe::compensation {
namespace nc_correction_test {

using Eigen::Vector3d;

// A machine without errors: what comes out is the program itself, split.
const Corrector& Perfect() {
  static const Corrector corrector(
      machine::VolumetricModel(machine::Chain::Parse(map::kColumn),
                               {{{-0.1, 0.1}, {-0.1, 0.1}, {-0.1, 0.1}}}),
      Vector3d::Zero());
  return corrector;
}

const NcOptions kCoarse{{1e-6, 0.5}, Vector3d::Zero(), Vector3d(0, 0, 0)};

std::string Corrected(std::string_view program, const Corrector& corrector = Perfect(),
                      const NcOptions& options = kCoarse) {
  NcSource source("", std::string(program));
  std::string out;
  CorrectProgram(corrector, options, source, [&](std::string_view piece) { out += piece; });
  return out;
}

std::string Refusal(std::string_view program, const NcOptions& options = kCoarse) {
  return map::MessageOf<InputError>([&] { Corrected(program, Perfect(), options); });
}

// All points of an output in G90.
std::vector<Vector3d> Points(const std::string& text) {
  std::vector<Vector3d> points;
  NcBlock block;
  map::Lines lines(text, "");
  for (std::string_view line; lines.Next(line);) {
    ReadBlock(line, 1, NcParameters(), block);
    Vector3d point;
    int axes = 0;
    for (const NcWord& word : block.words) {
      if (word.letter < 'X' || word.letter > 'Z') continue;
      point[word.letter - 'X'] = 1e-3 * word.value;
      ++axes;
    }
    if (axes == 3) points.push_back(point);
  }
  return points;
}

TEST(NcCorrection, KeepsEverythingThatIsNoMove) {
  const std::string text =
      "%\n(a part)\nN10 G21 G90 G17 G40\nT3 M6\n\nG4 P0.5 ; wait\nM3 S1000\nM30\n%\n";
  EXPECT_EQ(Corrected(text), text);
}

TEST(NcCorrection, WritesMovesInFullAndModalWordsOnce) {
  EXPECT_EQ(Corrected("N1 g0 x1 Y-2 Z.5 (over)\nN2 G1 Z-1.25 F100 M8\nX3\nG0 X0 M30 ; done\n"),
            "N1 (over) G0 X1 Y-2 Z0.5\nN2 F100 M8 G1 X1 Y-2 Z-1.25\nX3 Y-2 Z-1.25\n"
            "G0 X0 Y-2 Z-1.25 M30 ; done\n");
}

// A lathe whose X is 10 ppm too long, and which errs in Y, where it has no axis.
TEST(NcCorrection, AnAxisThatIsNotThereIsNeitherAskedForNorWritten) {
  machine::VolumetricModel lathe(machine::Chain::Parse("[w b Z X t]"),
                                 {{{0.0, 0.2}, {0.0, 0.0}, {0.0, 0.5}}});
  const auto line = machine::MakePolynomialForm(1, 0.0, 0.2);
  for (const int motion : {0, 1}) lathe.SetForm(0, motion, line);
  lathe.SetCoefficients(0, 0, Eigen::Vector2d(0.0, 1e-5 * 0.1));
  lathe.SetCoefficients(0, 1, Eigen::Vector2d(0.0, 2e-5 * 0.1));
  const Corrector corrector(lathe, Vector3d::Zero());
  EXPECT_EQ(Corrected("G21 G90 G18\nG0 X100 Z5\nG1 Z50 F200\nM2\n", corrector),
            "G21 G90 G18\nG0 X99.999 Z5\nF200 G1 X99.999 Z50\nM2\n");
  const auto table = CorrectTable("x_mm,z_mm\n100,5\n", "points.csv", corrector);
  EXPECT_EQ(table.text, "x_mm,z_mm\n100.001,5\n");
}

TEST(NcCorrection, KeepsUnitsAndIncrements) {
  EXPECT_EQ(Corrected("G20 G0 X1 Y0 Z0\nG91 G1 X-0.5\nG21 Y2.54\nG90 X0\n"),
            "G20 G0 X1 Y0 Z0\nG91 G1 X-0.5 Y0 Z0\nG21 X0 Y2.54 Z0\nG90 X0 Y2.54 Z0\n");
}

TEST(NcCorrection, SplitsLongLinesEvenly) {
  NcOptions options = kCoarse;
  options.limits.length = 0.010;
  EXPECT_EQ(Corrected("N5 G1 X25 F50 M0\n", Perfect(), options),
            "N5 F50 G1 X8.333333 Y0 Z0\nX16.666667 Y0 Z0\nX25 Y0 Z0 M0\n");
  EXPECT_EQ(Corrected("G0 X25\n", Perfect(), options), "G0 X25 Y0 Z0\n");
}

// Every chord's ends lie on the circle and its middle within the tolerance, in all planes, both
// senses, centre and radius, to the end that the program says.
TEST(NcCorrection, ArcsStayWithinTheChordTolerance) {
  struct Case {
    const char* program;
    Vector3d centre, normal, end;
    double sweep;
  };
  constexpr double kPi = std::numbers::pi;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const std::vector<Case> cases = {
      {"G3 X0 Y10 I-10", {0, 0, 0}, z, {0, 10, 0}, kPi / 2},
      {"G2 X0 Y10 I-10", {0, 0, 0}, z, {0, 10, 0}, -1.5 * kPi},
      {"G3 X0 Y10 R10", {0, 0, 0}, z, {0, 10, 0}, kPi / 2},
      {"G3 X0 Y10 R-10", {10, 10, 0}, z, {0, 10, 0}, 1.5 * kPi},
      {"G2 X0 Y10 R10", {10, 10, 0}, z, {0, 10, 0}, -kPi / 2},
      {"G2 I-10", {0, 0, 0}, z, {10, 0, 0}, -2 * kPi},
      {"G90.1 G3 X-10 Y0 I0 J0", {0, 0, 0}, z, {-10, 0, 0}, kPi},
      {"G18 G3 X0 Z-10 I-10", {0, 0, 0}, y, {0, 0, -10}, kPi / 2},
      {"G18 G2 X0 Z10 I-10 K0", {0, 0, 0}, y, {0, 0, 10}, -kPi / 2},
      {"G19 G3 Y10 Z10 J10", {10, 10, 0}, x, {10, 10, 10}, 1.5 * kPi},
      {"G91 G3 X-10 Y10 I-10 G90", {0, 0, 0}, z, {0, 10, 0}, kPi / 2},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.program);
    std::string program = one.program;
    const bool is_relative = program.starts_with("G91");
    if (is_relative) program = "G3 X0 Y10 I-10";  // the same arc; increments: KeepsUnits...
    const auto points = Points(Corrected("G0 X10 Y0 Z0\n" + program + "\n"));
    ASSERT_GT(points.size(), 20);
    const Vector3d centre = 1e-3 * one.centre;
    const double radius = (points[0] - centre).norm();
    double turned = 0.0, worst = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vector3d a = points[i - 1] - centre, b = points[i] - centre;
      EXPECT_NEAR(b.norm(), radius, 2e-9);  // written to 1 nm a coordinate
      worst = std::max(worst, radius - ((a + b) / 2).norm());
      turned += std::asin(a.cross(b).dot(one.normal) / (a.norm() * b.norm()));
    }
    EXPECT_LT(worst, 1e-6 + 2e-9);
    EXPECT_GT(worst, 0.5e-6);
    EXPECT_NEAR(turned, one.sweep, 1e-6);
    EXPECT_LT((points.back() - 1e-3 * one.end).norm(), 1e-12);
  }
}

TEST(NcCorrection, AHelixRisesEvenly) {
  const auto points = Points(Corrected("G0 X10 Y0 Z0\nG3 X10 Y0 I-10 Z5\n"));
  ASSERT_GT(points.size(), 100);
  const double step = 0.005 / static_cast<double>(points.size() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].z(), step * static_cast<double>(i), 1e-9);
  }
}

TEST(NcCorrection, CommandsTheCorrectedPlacesWithTheWorkOffset) {
  const map::ErrorMap map = map::RandomMap(2);
  const Corrector corrector(map, Vector3d::Zero());
  const NcOptions options{{1e-6, 0.5}, {0.02, 0.03, 0.04}, {}};
  const auto points = Points(Corrected("G90 G0 X5 Y-3 Z0\nG1 X-7 F9\n", corrector, options));
  ASSERT_EQ(points.size(), 2);
  const Vector3d wanted(0.013, 0.027, 0.04);
  EXPECT_LT((corrector.Made(points[1] + options.work_offset) - wanted).norm(), 1e-9);
  EXPECT_GT((points[1] + options.work_offset - wanted).norm(), 1e-6);
}

TEST(NcCorrection, IncrementsAddUpWithoutDrift) {
  const map::ErrorMap map = map::RandomMap(2);
  const Corrector corrector(map, Vector3d::Zero());
  std::string program = "G90 G0 X5 Y5 Z30\nG91\n";
  for (int i = 0; i < 100; ++i) program += "G1 X0.3333333 Y0.1\n";
  const std::string text = Corrected(program, corrector, {{1e-6, 0.5}, {0, 0, 0}, {}});
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& step : Points(text)) sum += step;
  const Vector3d wanted(0.005 + 0.03333333, 0.015, 0.030);
  EXPECT_LT((corrector.Made(sum) - wanted).norm(), 2e-9);
}

TEST(NcCorrection, WhatItCannotCorrectIsRefusedWithItsLine) {
  map::ExpectHas(Refusal("G0 X1\nG41 D1\n"),
                 "line 2: length and radius of a tool are in the tool table");
  const std::string called = Refusal("M98 P2\n");
  map::ExpectHas(called,
                 "line 1: M98: subroutines of M98 and M99 are not supported; write them as O");
  EXPECT_EQ(called.find("--copy"), std::string::npos);
  EXPECT_EQ(Refusal("M91\n").find("--copy"), std::string::npos);
  map::ExpectHas(Refusal("M110\n"), "keep it with --copy M110");
  map::ExpectHas(Refusal("G43 H1\n"), "line 1: length and radius of a tool are in the tool table");
  for (const char* const word :
       {"G81 Z-3", "G81 X1 Z-3 R-4", "G93 G1 X1", "G10 L2", "G10 L1 P1 X1", "G5", "G33", "G38.2 Z1",
        "G2.1", "G55", "M98", "M110", "A10", "U1", "E3", "H1", "G80 X1", "G1 G0 X1", "G30.1 A1"}) {
    map::ExpectHas(Refusal(std::string("G0 X1\n") + word + "\n"), "line 2: ");
  }
  for (const char* const word : {"#5221=3", "X[1+2", "X[1/0]", "X#7", "X#<depth>", "O100 sub",
                                 "O1 endif", "O1 call", "/G0 X1", "G1 X", "(open", "X1 X2"}) {
    map::ExpectHas(Refusal(std::string("G1\n") + word + "\n"), "line 2: ");
  }
  map::ExpectHas(Refusal("G80\nX1\n"), "line 2: axis words without");
  map::ExpectHas(Refusal("G1 X1 I2\n"), "belong to an arc");
  map::ExpectHas(Refusal("G2 X1\n"), "takes either I, J, K or R");
  map::ExpectHas(Refusal("G2 X1 K1\n"), "K does not belong to an arc in G17");
  map::ExpectHas(Refusal("G2 X50 R10\n"), "cannot reach over 50 mm");
  map::ExpectHas(Refusal("G2 X50 I10\n"), "starts 10 mm from its centre and ends 40 mm");
  map::ExpectHas(Refusal("G4 P1 X3\n"), "line 1: ");
  map::ExpectHas(Refusal("G0 X101\n"), "line 1: X = 101 mm lies outside its travel");
}

TEST(NcCorrection, WhatIsNoNumberAndNoCodeIsRefused) {
  for (const char* const word :
       {"Xnan", "Yinf", "Z-inf", "GnanX1", "Minf", "Fnan", "Ginfinity", "Xnan(char)"}) {
    map::ExpectHas(Refusal(std::string("G0 X1\n") + word + "\n"), "is not a letter with a number");
  }
  // 429496730.6 and 6553.6 are 1 and 0 in a word of 32 or 16 bits.
  for (const char* const word :
       {"G99999999999999999999", "G429496730.6", "G6553.6", "G1000", "G-1", "G0.05", "G1.00001",
        "M99999999999999999999", "M4294967298", "M-0.5", "M2.1"}) {
    map::ExpectHas(Refusal(std::string("G0 X1\n") + word + " X2\n"), "line 2: ");
    map::ExpectHas(Refusal(std::string("G0 X1\n") + word + " X2\n"), " is not supported");
  }
}

// Nothing of what is refused may be divided first: each of these would be 10^7 points and more, and
// the last ones more than any integer holds.
TEST(NcCorrection, TheTravelIsLookedAtBeforeAMoveIsDivided) {
  const NcOptions fine{{1e-9, 1e-7}, Vector3d::Zero(), Vector3d(0, 0, 0)};
  for (const char* const move :
       {"G1 X1000000000", "G91 G1 Y-1000000000", "G2 I1000000000", "G3 X0 Y10 I1000000 J5",
        "G2 X1 Y0 Z1000000000 I5 J0", "G18 G2 X30 Z30 R-100000", "G1 X1000000000000000000000000000",
        "G2 I1000000000000000000000000000000 J0", "G20 G1 X1000"}) {
    SCOPED_TRACE(move);
    const std::string refusal = Refusal(std::string(move) + "\n", fine);
    map::ExpectHas(refusal, "line 1: ");
    EXPECT_TRUE(refusal.find("lies outside its travel") != std::string::npos ||
                refusal.find("an arc of radius") != std::string::npos ||
                refusal.find("from its centre") != std::string::npos)
        << refusal;
  }
  // Its ends lie within, its far side beyond X = 100 mm.
  map::ExpectHas(Refusal("G0 X90 Y-30\nG3 Y30 J30\n"), "line 2: X = 120 mm lies outside");
  EXPECT_NO_THROW(Corrected("G0 X60 Y-30\nG3 Y30 J30\n"));
  // The shorter way round stays within.
  EXPECT_NO_THROW(Corrected("G0 X90 Y-30\nG2 Y30 J30\n"));
  NcOptions far = kCoarse;
  far.start = Vector3d(1e9, 0, 0);
  map::ExpectHas(Refusal("G1 X1\n", far), "--start: X = 1e+12 mm lies outside");
}

TEST(NcCorrection, AMoveIsNotDividedWithoutBounds) {
  map::ExpectHas(Refusal("G1 X50\n", {{1e-6, 1e-9}, Vector3d::Zero(), Vector3d(0, 0, 0)}),
                 "line 1: the move would become 5e+07 lines");
  map::ExpectHas(Refusal("G2 I10\n", {{1e-300, 0.5}, Vector3d::Zero(), Vector3d(0, 0, 0)}),
                 "line 1: the move would become ");
}

std::vector<std::string> Assumed(std::string_view program) {
  NcSource source("", std::string(program));
  const NcCounts counts = CorrectProgram(Perfect(), kCoarse, source, [](std::string_view) {});
  std::vector<std::string> assumed;
  for (const NcAssumption& one : counts.assumed) {
    assumed.push_back(one.what + " " + std::to_string(one.line));
  }
  return assumed;
}

TEST(NcCorrection, TellsWhatAProgramLeavesToItsControl) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(Assumed("M3\nG0 X1\nX2\nG2 X4 I1\n"),
            (Names{"millimetres (G21) 2", "absolute positions (G90) 2",
                   "arcs and cycles in XY (G17) 4"}));
  EXPECT_EQ(Assumed("G20\nG0 X1 G91\n"), Names());
  EXPECT_EQ(Assumed("G0 X1 G21\nG90\n"), Names{"absolute positions (G90) 1"});
  EXPECT_EQ(Assumed("G17 G21 G90\nG0 X1\nG2 X4 I1.5\n"), Names());
  EXPECT_EQ(Assumed("M3\nM30\n"), Names());
}

// RS 274/NGC, 2.1: a file that begins with % ends with %.
TEST(NcCorrection, AProgramThatWasCutHasNoEnd) {
  const auto finish = [](std::string_view program) { Corrected(program); };
  map::ExpectHas(map::MessageOf<InputError>([&] { finish("%\nG0 X1\nX2\n"); }),
                 "line 3: the program begins with %");
  EXPECT_NO_THROW(finish("%\nG0 X1\n%\n"));
  EXPECT_NO_THROW(finish("%\nG0 X1\nM30\n"));
  EXPECT_NO_THROW(finish("G0 X1\n"));
}

TEST(NcCorrection, ThePlaceOfTheMachineMustBeKnown) {
  NcOptions options = kCoarse;
  options.start.reset();
  map::ExpectHas(Refusal("G0 Z5\nG1 X1\n", options),
                 "line 2: moves while the position of the machine is unknown");
  map::ExpectHas(Refusal("G1 X1 Y1 Z1\n", options),
                 "line 1: moves while the position of the machine is unknown");
  EXPECT_EQ(Corrected("G0 X1 Y1 Z1\nG1 X2\n", Perfect(), options), "G0 X1 Y1 Z1\nG1 X2 Y1 Z1\n");
}

}  // namespace nc_correction_test
}  // namespace abbe::compensation
