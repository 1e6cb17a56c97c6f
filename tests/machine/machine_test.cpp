#include "machine/machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"

namespace abbe::machine {
namespace machine_test {

constexpr char kSmall[] = R"(
name = "small"
chain = "[w X Y b Z t]"
reference_mm = [1.0, 2.0, 3.0]
[axis.X]
travel_mm = [0.0, 60.0]
[axis.Y]
travel_mm = [-30.0, 30.0]
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
  ExpectRefusal(Replaced(kSmall, "[w X Y b Z t]", "fixed-brigde"),
                "small.toml:3: chain: \"fixed-brigde\" is no machine configuration; did you mean "
                "\"fixed-bridge\"?");
}

TEST(Machine, RefusesBadValuesWithFileLineAndKey) {
  ExpectRefusal(Replaced(kSmall, "b Z t", "Z t"), "small.toml:3: chain: ");
  ExpectRefusal(Replaced(kSmall, "[0.0, 60.0]", "[60.0, 0.0]"), "small.toml:6: axis.X.travel_mm: ");
  ExpectRefusal(Replaced(kSmall, "roll_urad", "rol_urad"), "roll_urad");
  ExpectRefusal(Replaced(kSmall, "[axis.Z]", "[axis.W]"), "axis.Z");
  ExpectRefusal(Replaced(kSmall, "12.0", "-12.0"), "small.toml:12: population.roll_urad: ");
}

TEST(Machine, TheDemonstrationMachineIsRead) {
  const Machine machine = ReadMachine(
      settings::Document::Read(std::string(ABBE_SOURCE_DIR) + "/machines/demo_mill.toml").Root());
  EXPECT_EQ(machine.name, "demo-mill");
  EXPECT_TRUE(machine.chain.CarriesTarget('X'));
  EXPECT_FALSE(machine.chain.CarriesTarget('Z'));
}

}  // namespace machine_test
}  // namespace abbe::machine
