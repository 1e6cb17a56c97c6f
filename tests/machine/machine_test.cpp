#include "machine/machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../folders.h"
#include "failure/failure.h"

namespace abbe::machine {
namespace machine_test {

constexpr char kSmall[] = R"(
name = "small"
chain = "[w X Y b Z t]"
reference_mm = [1.0, 2.0, 3.0]
[axis.X]
travel_mm = [0.0, 60.0]
positive = "carriage"
[axis.Y]
travel_mm = [-30.0, 30.0]
positive = "carriage"
[axis.Z]
travel_mm = [5.0, 45.0]
[population]
roll_urad = 12.0
)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void ExpectRefusal(const std::string& text, const std::string& reason) {
  try {
    ReadMachine(settings::Document::Parse(text, "small.toml").Root());
    ADD_FAILURE() << "accepted: " << reason;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(reason));
    EXPECT_THAT(error.what(), testing::StartsWith("small.toml"));
  }
}

TEST(Machine, IsReadInSi) {
  const Machine machine = ReadMachine(settings::Document::Parse(kSmall, "small.toml").Root());
  EXPECT_EQ(machine.name, "small");
  EXPECT_EQ(machine.chain.Text(), "[w X Y b Z t]");
  EXPECT_DOUBLE_EQ(machine.reference.y(), 0.002);
  EXPECT_DOUBLE_EQ(machine.travels[1].first, -0.030);
  EXPECT_DOUBLE_EQ(machine.travels[2].last, 0.045);
  EXPECT_DOUBLE_EQ(machine.population.roll, 12e-6);
  EXPECT_DOUBLE_EQ(machine.population.scale, 20e-6);
  EXPECT_DOUBLE_EQ(machine.population.smoothness, 0.015);
}

TEST(Machine, AConfigurationStandsForItsChain) {
  const auto chain = [](const std::string& given) {
    const std::string text = Replaced(kSmall, "[w X Y b Z t]", given);
    return ReadMachine(settings::Document::Parse(text, "small.toml").Root()).chain.Text();
  };
  EXPECT_EQ(chain("fixed-bridge"), "[w Y b X Z t]");
  EXPECT_EQ(chain("[w Y b X Z t]"), "[w Y b X Z t]");
  ExpectRefusal(
      Replaced(kSmall, "[w X Y b Z t]", "fixed-brigde"),
      "small.toml:3: chain: \"fixed-brigde\" is not a machine configuration; did you mean "
      "\"fixed-bridge\"?");
}

TEST(Machine, RefusesBadValuesWithFileLineAndKey) {
  ExpectRefusal(Replaced(kSmall, "b Z t", "Z t"), "small.toml:3: chain: ");
  ExpectRefusal(Replaced(kSmall, "[0.0, 60.0]", "[60.0, 0.0]"), "small.toml:6: axis.X.travel_mm: ");
  ExpectRefusal(Replaced(kSmall, "roll_urad", "rol_urad"), "roll_urad");
  ExpectRefusal(Replaced(kSmall, "[axis.Z]", "[axis.W]"), "axis.Z");
  ExpectRefusal(Replaced(kSmall, "positive = \"carriage\"", "positive = \"table\""),
                "small.toml:7: axis.X.positive: \"table\" is not one of: tool, carriage");
  ExpectRefusal(Replaced(kSmall, "\n[axis.Z]", "\nlimit_mm = [-20.0, 31.0]\n[axis.Z]"),
                "small.toml:11: axis.Y.limit_mm: must be [first, last]");
  ExpectRefusal(Replaced(kSmall, "12.0", "-12.0"), "small.toml:14: population.roll_urad: ");
}

// Nobody guesses which way a table counts: the line says what to write.
TEST(Machine, AsksHowAnAxisCountsThatCarriesTheWorkpiece) {
  const std::string without = Replaced(kSmall, "positive = \"carriage\"\n", "");
  ExpectRefusal(without,
                "small.toml:5: axis.X.positive: is missing: X carries the workpiece; write "
                "positive = \"tool\"");
  // An axis that carries the tool counts as the tool goes, and may say so.
  const auto read = [](const std::string& text) {
    return ReadMachine(settings::Document::Parse(text, "small.toml").Root()).chain;
  };
  const std::string bridge = Replaced(without, "[w X Y b Z t]", "[w Y b X Z t]");
  EXPECT_EQ(read(bridge).PositiveText(), "tool carriage tool");
  const std::string iso = Replaced(bridge, "\"carriage\"", "\"tool\"");
  EXPECT_EQ(read(iso).PositiveText(), "tool tool tool");
  EXPECT_EQ(read(iso).CarriageSense('Y'), -1.0);
  EXPECT_EQ(read(iso).ToolSense('Y'), 1.0);
  EXPECT_EQ(read(bridge).ToolSense('Y'), -1.0);
}

// Soft limits are the control's: those of the file, or a tenth of a millimetre beyond the travel.
TEST(Machine, HasSoftLimitsAroundItsTravels) {
  const std::string text = Replaced(kSmall, "\n[axis.Z]", "\nlimit_mm = [-31.0, 30.5]\n[axis.Z]");
  const Machine machine = ReadMachine(settings::Document::Parse(text, "small.toml").Root());
  EXPECT_DOUBLE_EQ(machine.limits[1].first, -0.031);
  EXPECT_DOUBLE_EQ(machine.limits[1].last, 0.0305);
  EXPECT_DOUBLE_EQ(machine.limits[0].first, -0.0001);
  EXPECT_DOUBLE_EQ(machine.limits[0].last, 0.0601);
}

TEST(Machine, TheDemonstrationMachineIsRead) {
  const Machine machine = ReadMachine(settings::Document::Read(DemoMillFile()).Root());
  EXPECT_EQ(machine.name, "demo-mill");
  EXPECT_TRUE(machine.chain.CarriesTarget('X'));
  EXPECT_FALSE(machine.chain.CarriesTarget('Z'));
}

}  // namespace machine_test
}  // namespace abbe::machine
