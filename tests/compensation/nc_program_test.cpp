#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "compensation/nc_block.h"
#include "compensation/nc_correction.h"
#include "compensation/nc_cycles.h"
#include "failure/failure.h"
#include "map/words.h"
#include "map_cases.h"

namespace abbe::compensation {
namespace nc_program_test {

using Eigen::Vector3d;

// A machine without errors: the output is the program written out.
const Corrector& NoErrors() {
  static const Corrector corrector(
      machine::VolumetricModel(machine::Chain::Parse(map::kColumn),
                               {{{-0.5, 0.5}, {-0.5, 0.5}, {-0.5, 0.5}}}),
      Vector3d::Zero());
  return corrector;
}

NcOptions Options() {
  NcOptions options;
  options.limits = {1e-6, 1.0};
  options.start = Vector3d::Zero();
  return options;
}

std::string WrittenOut(std::string_view program, const NcOptions& options = Options(),
                       const Corrector& corrector = NoErrors()) {
  NcSource source("", std::string(program));
  std::string out;
  CorrectProgram(corrector, options, source, [&](std::string_view piece) { out += piece; });
  return out;
}

std::string RefusalOf(std::string_view program, const NcOptions& options = Options()) {
  return map::MessageOf<InputError>([&] { WrittenOut(program, options); });
}

// A % must stand first; a program that carries the mark is corrected.
TEST(NcProgram, CarriesAMarkByWhichItIsKnown) {
  NcOptions options = Options();
  options.mark = MarkOf("a (b).toml", "2026-11-21T09:00:00Z");
  const std::string mark = "(corrected by abbe with the map a _b_.toml of 2026-11-21T09:00:00Z)\n";
  EXPECT_EQ(options.mark + "\n", mark);
  EXPECT_EQ(MarkOf("m.toml", ""), "(corrected by abbe with the map m.toml)");
  const std::string marked = WrittenOut("G21 G90\nG0 X0\nM2\n", options);
  EXPECT_TRUE(marked.starts_with(mark + "G21 G90\n")) << marked;
  const std::string open = WrittenOut("\n%\nG21 G90\nM2\n%\n", options);
  EXPECT_TRUE(open.starts_with("\n%\n" + mark + "G21 G90\n")) << open;
  EXPECT_EQ(WrittenOut("G21 G90\nM2\n").find("corrected"), std::string::npos);
  map::ExpectHas(RefusalOf(open), "line 3: the program is corrected already");
  options.corrects_again = true;
  options.mark.clear();
  EXPECT_EQ(WrittenOut(marked, options), marked);
}

double ValueOf(std::string_view text) {
  const NcParameters parameters;
  return NcCursor(text, 1, parameters).Value();
}

// RS 274/NGC, 3.3.2.2 and LinuxCNC's order of operators; values by hand.
TEST(NcExpression, OperatorsBindAsLinuxcncSays) {
  EXPECT_DOUBLE_EQ(ValueOf("[2 + 3 * 4]"), 14.0);
  EXPECT_DOUBLE_EQ(ValueOf("[2 ** 3 ** 2]"), 64.0);  // from the left
  EXPECT_DOUBLE_EQ(ValueOf("[-2 ** 2]"), 4.0);       // the sign belongs to the number
  EXPECT_DOUBLE_EQ(ValueOf("[7 MOD 3 + 10 / 4]"), 3.5);
  EXPECT_DOUBLE_EQ(ValueOf("[-7 mod 3]"), 2.0);
  EXPECT_DOUBLE_EQ(ValueOf("[1 LT 2 AND 3 GT 4]"), 0.0);
  EXPECT_DOUBLE_EQ(ValueOf("[1 lt 2 or 3 gt 4]"), 1.0);
  EXPECT_DOUBLE_EQ(ValueOf("[1 eq 1.0000001]"), 1.0);
  EXPECT_DOUBLE_EQ(ValueOf("[1 ne 1.00001]"), 1.0);
  EXPECT_DOUBLE_EQ(ValueOf("atan[1]/[-1]"), 135.0);
  EXPECT_DOUBLE_EQ(ValueOf("[s q r t [2] * sin[45]]"), 1.0);
  EXPECT_DOUBLE_EQ(ValueOf("fix[-2.8]"), -3.0);
  EXPECT_DOUBLE_EQ(ValueOf("fup[2.2]"), 3.0);
  EXPECT_DOUBLE_EQ(ValueOf("round[-2.5]"), -3.0);
  EXPECT_DOUBLE_EQ(ValueOf("-[-[3]]"), 3.0);
}

TEST(NcExpression, WhatHasNoValueIsRefused) {
  for (const char* const text :
       {"[1/0]", "[5 mod 0]", "sqrt[-1]", "ln[0]", "acos[2]", "[1 +", "[-8 ** 0.5]", "#<none>",
        "#9999", "#0", "sin 3", "[1 2]", "exp[999]"}) {
    SCOPED_TRACE(text);
    EXPECT_THROW(ValueOf(text), InputError);
  }
  const std::string deep = std::string(1000, '[') + "1" + std::string(1000, ']');
  map::ExpectHas(map::MessageOf<InputError>([&] { ValueOf(deep); }), "nested more than 64 deep");
}

TEST(NcExpression, WhatOnlyTheControlKnowsStaysUnknown) {
  EXPECT_TRUE(std::isnan(ValueOf("[#100 * 0 + 1]")));
  NcParameters parameters({}, NcParameters::Stored{{{100, 7.0}}});
  EXPECT_EQ(NcCursor("[#100 + #101]", 1, parameters).Value(), 7.0);
}

TEST(NcProgram, ParametersActAfterTheirBlock) {
  EXPECT_EQ(WrittenOut("#1=2\n#1=5 G0 X#1\nX#1\n#<a b>=3\nX#<AB>\n#3=1\nX##3 (#3)\n"),
            "G0 X2 Y0 Z0\nX5 Y0 Z0\nX3 Y0 Z0\n(#3) X5 Y0 Z0\n");
}

TEST(NcProgram, LoopsBranchesAndSubroutinesAreWrittenOut) {
  EXPECT_EQ(WrittenOut("o1 repeat [3]\nG91 G0 X1\no1 endrepeat\n"),
            "G91 G0 X1 Y0 Z0\nG91 X1 Y0 Z0\nG91 X1 Y0 Z0\n");
  EXPECT_EQ(WrittenOut("#1=0\no1 while [#1 lt 5]\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\n"
                       "o2 else if [#1 eq 4]\no1 break\no2 endif\nG0 X#1\no1 endwhile\n"),
            "G0 X1 Y0 Z0\nX3 Y0 Z0\n");
  EXPECT_EQ(WrittenOut("#1=0\no1 do\n#1=[#1+1]\nG0 X#1\no1 while [#1 lt 2]\n"),
            "G0 X1 Y0 Z0\nX2 Y0 Z0\n");
  EXPECT_EQ(WrittenOut("o<s> sub\nG0 X#1 Y#2\n#1=9\no<s> return [#1*2]\nG0 X99\no<s> endsub\n"
                       "#1=4\no<s> call [#1] [1]\nZ[#1+#<_value>]\nM2\n"),
            "G0 X4 Y1 Z0\nX4 Y1 Z22\nM2\n");
}

TEST(NcProgram, WhatNeverEndsIsRefusedInTime) {
  NcOptions options = Options();
  options.most_steps = 1000;
  map::ExpectHas(RefusalOf("o1 while [1]\no1 endwhile\n", options),
                 "the program has not ended after 1000 lines");
  map::ExpectHas(RefusalOf("o1 repeat [1000000000]\no1 endrepeat\n", options), "has not ended");
  map::ExpectHas(RefusalOf("o<s> sub\no<s> call\no<s> endsub\no<s> call\n"),
                 "call each other more than 9 deep");
  options = Options();
  options.most_lines = 100;
  map::ExpectHas(RefusalOf("o1 repeat [200]\nG0 X1\no1 endrepeat\n", options),
                 "would have more than 1e+02 lines");
  map::ExpectHas(RefusalOf("G81 X1 Z-1 R1 L1000000000\n"), "is no number of holes");
  map::ExpectHas(RefusalOf("G83 X1 Z-1 R1 Q0.0000001\n"), "would become more than 1e+06 lines");
  map::ExpectHas(RefusalOf("G2 I1 P1000000000\n"), "is no number of turns");
}

TEST(NcProgram, AWayByAValueOfTheControlIsRefused) {
  map::ExpectHas(RefusalOf("M66 P0 L0\no1 if [#5399 gt 0]\nG0 X1\no1 endif\n"),
                 "line 3: whether this acts is known only at the control");
  map::ExpectHas(RefusalOf("M66 P0 L0\no1 while [#5399 gt 0]\nM0\no1 endwhile\n"),
                 "line 2: the way of the program depends on a value that is known only at the");
  map::ExpectHas(RefusalOf("G0 X#<_hal[a.b]>\n"), "line 1: X#<_hal[a.b]> depends on a value");
  EXPECT_EQ(WrittenOut("F#<_hal[a.b]>\n"), "F#<_hal[a.b]>\n");
}

// As LinuxCNC reads it: correct_by_rs274_test.py.
TEST(NcProgram, ABranchByAValueOfTheControlIsKeptForIt) {
  const std::string program =
      "#<limit> = 2\no1 if [#<_hal[lamp.level]> GT #<limit>]\n(debug, above #<limit>)\n"
      "o1 elseif [EXISTS[#<_hal[lamp.level]>] AND EXISTS[#<limit>]]\nM65 P1\no1 endif\nG0 X1\n";
  EXPECT_EQ(WrittenOut(program),
            "O<kept1> if [#<_hal[lamp.level]> GT [2.000000000]]\n(debug, above 2.000000)\n"
            "O<kept1> elseif [EXISTS[#<_hal[lamp.level]>] AND [1.000000000]]\nM65 P1\n"
            "O<kept1> endif\nG0 X1 Y0 Z0\n");
  // A return leaves out the rest of its subroutine alone.
  EXPECT_EQ(WrittenOut("o<s> sub\no1 if [#5399 lt 0]\no1 return [-1]\no1 endif\n#<p> = 3\n"
                       "M64 P#<p>\no<s> endsub\nM66 P0 L0\no<s> call\nM0\n"),
            "M66 P0 L0\nO<kept1> if [#5399 lt 0]\nO<kept1> else\nM64 P3\n"
            "O<kept1> endif\nM0\n");
}

// A tool of 2 mm beside corners to either side and an arc; places by hand.
TEST(NcProgram, TheToolGoesBesideThePath) {
  NcOptions options = Options();
  options.limits.chord = 1.0;  // an arc of up to half a turn is one chord
  EXPECT_EQ(WrittenOut("G41.1 D4 (on)\nG1 X10 F100 (in)\nG1 Y10\nF50\nX-5 M0\nG40\nX0\n", options),
            "(on)\nF100 (in) G1 X8 Y2 Z0\nX8 Y8 Z0\nF50\nX-5 Y8 Z0 M0\nG40\nX0 Y10 Z0\n");
  EXPECT_EQ(WrittenOut("G42.1 D4\nG1 X10\nY10\nG0 Z3\nG3 X-10 I-10\n", options),
            "G1 X10 Y-2 Z0\nX12 Y0 Z0\nX12 Y10 Z0\nG0 X12 Y10 Z3\nG1 X-12 Y10 Z3\n");
  // A negative diameter is on the other side.
  EXPECT_EQ(WrittenOut("G42.1 D-4\nG1 X10\nM2\n", options), "G1 X10 Y2 Z0\nM2\n");
}

TEST(NcProgram, AToolThatDoesNotFitIsRefused) {
  const std::string on = "G41.1 D4\nG1 X10\n";
  map::ExpectHas(RefusalOf("G41.1 D4\nG1 X2\n"), "line 2: the first move after G41 or G42 must be");
  map::ExpectHas(RefusalOf(on + "G3 Y2 J1\nG40\n"), "line 3: the tool does not fit into the arc");
  map::ExpectHas(RefusalOf(on + "Y3\nX0\nG40\n"), "line 3: the tool does not fit between");
  map::ExpectHas(RefusalOf(on + "G40\nG2 X0 I-5\n"), "line 4: an arc right after G40");
  map::ExpectHas(RefusalOf(on + "G40\nG92 X0\n"), "line 4: the tool still stands beside");
  map::ExpectHas(RefusalOf("G41\n"), "line 1: G41 or G42 without D");
  map::ExpectHas(RefusalOf("G19 G41.1 D4\n"), "line 1: G41 and G42 belong to the planes");
  for (const char* const word : {"G42.1 D4", "G20", "G91", "G18", "G55", "G92 X1", "G10 L2 P1 X1",
                                 "G53 G0 X1", "G28", "G81 Z-1 R1", "T1 M6", "G49", "M70", "G80"}) {
    map::ExpectHas(RefusalOf(on + word + "\n"), "line 3: ");
  }
}

TEST(NcProgram, BlocksThatMayBeLeftOutNeedTheSwitch) {
  NcOptions options = Options();
  map::ExpectHas(RefusalOf("/G0 X1\n"), "--block-delete");
  options.deletes_blocks = true;
  EXPECT_EQ(WrittenOut("/G0 X1\nG0 X2\n", options), "G0 X2 Y0 Z0\n");
  options.deletes_blocks = false;
  EXPECT_EQ(WrittenOut("/G0 X1\nG0 X2\n", options), "G0 X1 Y0 Z0\nX2 Y0 Z0\n");
}

TEST(NcProgram, OffsetsMoveTheProgramOverTheMachine) {
  NcOptions options = Options();
  options.tables.tools = {{3, {{0.0, 0.0, 50.0}, 6.0}}};
  map::ExpectHas(RefusalOf("G43 H3\n", options), "give with --tool the point of a tool whose");
  options.p_TQ_gauge = Vector3d::Zero();
  // Machine coordinates stay where they are while the program's change.
  EXPECT_EQ(WrittenOut("G0 X1 Y2 Z3\nG92 X0\nG53 G0 X1\nG10 L2 P2 X10 Y0 Z0\nG55\nG53 X1\n"
                       "G92.1\nG53 X1\nG43 H3\nG53 X1 Z0\nG49\nG53 X1\n",
                       options),
            "G0 X1 Y2 Z3\nG92 X0\nX0 Y2 Z3\nG10 L2 P2 X10 Y0 Z0\nG55\nX-10 Y2 Z3\n"
            "G92.1\nX-9 Y2 Z3\nG43 H3\nX-9 Y2 Z-50\nG49\nX-9 Y2 Z0\n");
}

// A zero set by the program (G92) is where the control stands, which is the corrected place.
TEST(NcProgram, TheControlTakesItsOwnPlaceForAnOffset) {
  const map::ErrorMap map = map::RandomMap(4);
  const Corrector corrector(map, Vector3d(0.01, 0.0, -0.05));
  NcOptions options = Options();
  options.start = Vector3d(0.030, 0.030, 0.030);
  const std::string plain = WrittenOut("G0 X20 Y10 Z15\nG1 X25 Y15 Z10\n", options, corrector);
  const std::string shifted =
      WrittenOut("G0 X20 Y10 Z15\nG92 X0 Y0 Z0\nG1 X5 Y5 Z-5\n", options, corrector);
  const auto last = [](const std::string& text) {
    NcBlock block;
    const std::size_t at = text.rfind('\n', text.size() - 2);
    ReadBlock(std::string_view(text).substr(at + 1, text.size() - at - 2), 1, NcParameters(),
              block);
    Vector3d p = Vector3d::Zero();
    for (const NcWord& word : block.words) {
      if (word.letter >= 'X' && word.letter <= 'Z') p[word.letter - 'X'] = word.value;
    }
    return p;
  };
  const Vector3d at = last(plain.substr(0, plain.find('\n') + 1));
  EXPECT_LT((at + last(shifted) - last(plain)).norm(), 2e-6);  // mm, rounding of two words
  EXPECT_GT((last(shifted) - Vector3d(5, 5, -5)).norm(), 1e-5);
}

// RS 274/NGC, 3.5.16.3: G83 X Y Z R Q; out to R.
TEST(NcCycles, PecksGoDownByQAndBackToTheirBottom) {
  NcCycle cycle;
  cycle.code = 83;
  cycle.holes = {{4.0, 5.0}};
  cycle.initial = 3.0;
  cycle.r = 1.8;
  cycle.bottom = -0.6;
  cycle.peck = 1.0;
  std::vector<double> z;
  std::string kinds;
  for (const NcCycleStep& step : StepsOf(cycle, Vector3d(1.0, 2.0, 3.0), 1)) {
    z.push_back(step.to.z());
    kinds += step.step == NcStep::kRapid ? 'r' : 'f';
  }
  cycle.retracts_to_r = true;
  const std::vector<double> expected = {3.0, 1.8, 0.8, 3.0, 1.054, -0.2, 3.0, 0.054, -0.6, 3.0};
  ASSERT_EQ(z.size(), expected.size());
  for (std::size_t i = 0; i < z.size(); ++i) EXPECT_NEAR(z[i], expected[i], 1e-12) << i;
  EXPECT_EQ(kinds, "rrfrrfrrfr");
  EXPECT_NEAR(StepsOf(cycle, Vector3d(1.0, 2.0, 3.0), 1).back().to.z(), 1.8, 1e-12);
}

TEST(NcProgram, WhatIsSavedIsRestored) {
  EXPECT_EQ(WrittenOut("G21 G90 F100\no<s> sub\nM73\nG20 G91 F5\nG0 X1\no<s> endsub\no<s> call\n"
                       "G0 X1\n"),
            "G21 G90 F100\nG20 G91 F5\nG0 X1 Y0 Z0\nG21 G90 F100\nX1 Y0 Z0\n");
}

TEST(NcProgram, AFileOfSubroutinesAloneIsRefused) {
  map::ExpectHas(RefusalOf("o<s> sub\nG0 X1\no<s> endsub\nM2\n"), "defines the subroutine O<s>");
}

TEST(NcProgram, RotaryAxesTurnAlongTheDividedMove) {
  NcOptions options = Options();
  map::ExpectHas(RefusalOf("G0 A10\n"), "--rotary table");
  options.allowed.rotary = true;
  options.limits.length = 0.010;
  EXPECT_EQ(WrittenOut("G0 X0 A10\nG1 X20 A30 F100\nG91 X20 A-5\n", options),
            "G0 X0 Y0 Z0 A10\nF100 G1 X10 Y0 Z0 A20\nX20 Y0 Z0 A30\n"
            "G91 X10 Y0 Z0 A-2.5\nX10 Y0 Z0 A-2.5\n");
  map::ExpectHas(RefusalOf("G1 X20 A30 F100\n", options), "where A stands is not known");
  EXPECT_EQ(WrittenOut("G92 X5\nG53 G0 X1 A30\nX6\n", options),
            "G92 X5\nG53 G0 X1 Y0 Z0 A30\nX6 Y0 Z0\n");
}

TEST(NcProgram, InverseTimeIsDividedWithTheMove) {
  NcOptions options = Options();
  options.limits.length = 0.010;
  EXPECT_EQ(WrittenOut("G93 G1 X20 F3\n", options), "G93 G1 X10 Y0 Z0 F6\nX20 Y0 Z0 F6\n");
}

// Until all three axes are known, a rapid is copied; and so is G28 to a place that is not known.
TEST(NcProgram, WhatCannotBeCorrectedYetIsCopiedAndCounted) {
  NcOptions options = Options();
  options.start.reset();
  NcSource source("", "G0 Z5\nX1 Y2\nG1 X2 F100\nG91 G28 Z0\nM30\n");
  std::string out;
  const NcCounts counts =
      CorrectProgram(NoErrors(), options, source, [&](std::string_view piece) { out += piece; });
  EXPECT_EQ(out, "G0 Z5\nX1 Y2 Z5\nF100 G1 X2 Y2 Z5\nG91 G28 Z0\nM30\n");
  EXPECT_EQ(counts.copied_moves, 2U);
  ASSERT_EQ(counts.uncorrected.size(), 2U);
  EXPECT_EQ(counts.uncorrected[1].line, 4U);
}

}  // namespace nc_program_test
}  // namespace abbe::compensation
