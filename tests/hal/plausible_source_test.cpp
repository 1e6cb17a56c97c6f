// Numbers that no machine gives: seen at the first readings, and while a recording goes on.
#include "hal/plausible_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "failure/failure.h"
#include "hal/modbus/fake_source.h"
#include "random/counter_random.h"

namespace abbe::hal {
namespace plausible_source_test {

using testing::HasSubstr;

constexpr double kRate = 200.0;
constexpr int kCount = 50;

// An axis of 0 to 60 mm in 32 bits of 10 nm, and two gaps of 0 to 200 um.
class Readings {
 public:
  Readings() {
    ChannelSettings axis;
    axis.name = "x_mm";
    axis.type = WordType::kInt32;
    axis.scale = 1e-5;
    axis.may_freeze = true;
    channels_ = {axis};
    for (const char* name : {"probe_a_um", "probe_b_um"}) {
      ChannelSettings probe;
      probe.name = name;
      probe.type = WordType::kFloat32;
      channels_.push_back(probe);
      plausible_.push_back(
          {name, {0.0, 200.0}, {-200.0, 400.0}, "the probe's range is 0 to 200 um", 0.4, 0.02});
    }
    plausible_.push_back(
        {"x_mm", {-16.0, 76.0}, {-16.0, 76.0}, "the travel is 0 to 60 mm", 0.0, 0.0, 0.005});
  }
  std::vector<std::string> Require() {
    FakeSource source(channels_, truth, 1.0, clock_);
    PlausibleSource plausible(source, plausible_);
    return plausible.Require(kCount, clock_, kRate);
  }
  std::string Refusal() {
    try {
      Require();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::function<double(const std::string&, double)> truth = [](const std::string& name, double t) {
    return name == "x_mm" ? 30.0 : 100.0 + 0.03 * std::sin(1e4 * t);
  };
  std::vector<ChannelSettings> channels_;
  std::vector<PlausibleChannel> plausible_;
  HandClock clock_;
};

TEST(PlausibleSource, TakesAMachineAsItIs) { EXPECT_TRUE(Readings().Require().empty()); }

TEST(PlausibleSource, RefusesAPositionInTheWrongOrderOfWords) {
  Readings readings;
  readings.truth = [](const std::string& name, double t) {
    if (name != "x_mm") return 100.0 + std::sin(t);
    std::array<std::uint16_t, 2> words{};
    StoreNumber(3'000'123, WordType::kInt32, WordOrder::kABCD, words);
    return 1e-5 * NumberOf(words, WordType::kInt32, WordOrder::kCDAB);
  };
  const std::string refusal = readings.Refusal();
  EXPECT_THAT(refusal, HasSubstr("x_mm reads -"));
  EXPECT_THAT(refusal, HasSubstr("the travel is 0 to 60 mm"));
  EXPECT_THAT(refusal, HasSubstr("`order`"));
}

TEST(PlausibleSource, RefusesGapsAThousandTimesOff) {
  Readings readings;
  readings.truth = [](const std::string& name, double t) {
    return name == "x_mm" ? 30.0 : 1e3 * (100.0 + 0.03 * std::sin(1e4 * t));
  };
  EXPECT_THAT(readings.Refusal(), HasSubstr("probe_a_um reads 1000"));
  readings.truth = [](const std::string& name, double t) {
    return name == "x_mm" ? 30.0 : 1e-3 * (100.0 + 0.03 * std::sin(1e4 * t));
  };
  EXPECT_THAT(readings.Refusal(), HasSubstr("close to zero"));
  readings.truth = [](const std::string& name, double) { return name == "x_mm" ? 30.0 : 0.0; };
  EXPECT_THAT(readings.Refusal(), HasSubstr("an amplifier that is off"));
  // One probe at the target, or in the air, shows no wrong units.
  readings.truth = [](const std::string& name, double t) {
    return name == "x_mm" ? 30.0 : name == "probe_a_um" ? 0.0 : 250.0 + 0.03 * std::sin(1e4 * t);
  };
  EXPECT_EQ(readings.Refusal(), "");
}

TEST(PlausibleSource, SaysThatThereIsNoNoiseOrFarTooMuch) {
  Readings readings;
  readings.truth = [](const std::string& name, double t) {
    if (name == "x_mm") return 30.0;
    return name == "probe_a_um" ? 100.0 : 100.0 + 20.0 * std::sin(1e4 * t);
  };
  const auto warnings = readings.Require();
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_THAT(warnings[0], HasSubstr("probe_a_um in its first 50 readings: no noise at all, 100"));
  EXPECT_THAT(warnings[1], HasSubstr("probe_b_um in its first 50 readings: a noise of 14"));
}

TEST(PlausibleSource, FlagsWhatIsImpossibleWhileItGoesOn) {
  Readings readings;
  readings.truth = [](const std::string& name, double t) {
    if (name != "x_mm") return name == "probe_a_um" && t > 1.0 && t < 2.0 ? 250.0 : 100.0 + t;
    return t > 3.0 && t < 4.0 ? -20363.0 : 30.0;
  };
  FakeSource source(readings.channels_, readings.truth, 1.0, readings.clock_);
  PlausibleSource plausible(source, readings.plausible_);
  for (int i = 0; i < 50; ++i) {
    readings.clock_.Advance(0.1);
    const double now = readings.clock_.Now();
    const SampleSet set = plausible.Read();
    const bool far = now > 3.0 && now<4.0, wide = now> 1.0 && now < 2.0;
    EXPECT_EQ(set.samples[0].cause, far ? Cause::kOutOfRange : Cause::kNone) << now;
    EXPECT_EQ(std::isnan(set.samples[0].value), far);
    EXPECT_EQ(set.samples[1].cause, wide ? Cause::kOutOfRange : Cause::kNone) << now;
    EXPECT_TRUE(set.samples[2].good());
    EXPECT_EQ(plausible.Fault().substr(0, 10), far ? "x_mm reads" : "");
  }
}

// A sweep of stays of 0.5 s with moves of 0.1 s between, 200 readings a second. `noise`: what probe b
// adds at a time, um.
std::vector<std::string> WarningsOfASweep(Readings& readings,
                                          const std::function<double(double)>& noise) {
  const random::CounterRandom normal(3, 1);
  const auto place = [](double t) {
    const double stays = std::floor(t / 0.6), moving = t - 0.6 * stays - 0.5;
    return 10.0 + stays + std::max(0.0, 10.0 * moving);
  };
  readings.truth = [&](const std::string& name, double t) {
    const double x = place(t);
    if (name == "x_mm") return x;
    const auto tick = static_cast<std::uint64_t>(std::llround(1e4 * t));
    const double white = 0.02 * normal.Normal(2 * tick + (name == "probe_b_um" ? 1 : 0));
    // 1 mrad of tilt: 10 um/s in a move.
    return 100.0 + x + white * (name == "probe_b_um" ? noise(t) / 0.02 : 1.0);
  };
  FakeSource source(readings.channels_, readings.truth, 1.0, readings.clock_);
  PlausibleSource plausible(source, readings.plausible_);
  plausible.Require(kCount, readings.clock_, kRate);
  std::vector<std::string> warnings;
  for (int i = 0; i < 4000; ++i) {
    readings.clock_.Advance(1.0 / kRate);
    plausible.Read();
    for (std::string& each : plausible.TakeWarnings()) warnings.push_back(std::move(each));
  }
  return warnings;
}

TEST(PlausibleSource, TellsANoiseThatGrowsWhileItGoesOn) {
  Readings readings;
  const auto warnings = WarningsOfASweep(readings, [](double t) { return t < 10.0 ? 0.02 : 0.3; });
  ASSERT_EQ(warnings.size(), 1u);  // once, of this probe
  EXPECT_THAT(warnings[0], HasSubstr("probe_b_um: a noise of 0."));
  EXPECT_THAT(warnings[0], HasSubstr("the machine file says 0.02"));
}

TEST(PlausibleSource, TellsNoNoiseOfMovesAndOfWhatIsThreeTimesTheStated) {
  Readings readings;
  EXPECT_THAT(WarningsOfASweep(readings, [](double) { return 0.06; }), testing::IsEmpty());
  // Vibration while it moves and for 90 ms after.
  EXPECT_THAT(WarningsOfASweep(readings,
                               [](double t) {
                                 const double in_stay = t - 0.6 * std::floor(t / 0.6);
                                 return in_stay > 0.5 || in_stay < 0.09 ? 5.0 : 0.02;
                               }),
              testing::IsEmpty());
}

}  // namespace plausible_source_test
}  // namespace abbe::hal
