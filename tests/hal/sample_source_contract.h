// The contract of sample_source.h as one test for every sibling. A program includes this file and
// instantiates SampleSourceContract with its rigs.
//
// Every rig plays the same scene: ticks of 0.1 s on a hand clock; readings that change from tick to
// tick; from tick 20 to 39 the trouble, on both channels; then all is well again.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/modbus/modbus_settings.h"
#include "hal/sample_source.h"

namespace abbe::hal {

constexpr double kTick = 0.1, kStale = 1.0;
constexpr int kTroubleFrom = 20, kTroubleTo = 40, kTicks = 70;
constexpr double kStep = 200.0 / 65536;  // um, of the converter

enum class Trouble { kLost, kLate, kDoubled, kRefused, kFrozen, kSaturated, kSentinel };

// The truth of both channels at a tick, on the converter's grid.
inline std::uint16_t TrueWord(std::size_t channel, int tick) {
  return static_cast<std::uint16_t>(20000 + 1000 * channel + 7 * tick);
}

inline std::vector<ChannelSettings> ContractChannels() {
  std::vector<ChannelSettings> channels(2);
  for (std::size_t i = 0; i < 2; ++i) {
    channels[i].name = i == 0 ? "probe_a_um" : "probe_b_um";
    channels[i].at = static_cast<int>(i);
    channels[i].scale = kStep;
    channels[i].sentinels = {65535};
    channels[i].maximum = 190.0;
  }
  channels[0].sentinels = {65535, 64000};
  channels[1].sentinels = {64000, 65535};
  return channels;
}

class ContractRig {
 public:
  virtual ~ContractRig() = default;
  virtual SampleSource& source() = 0;
  virtual Clock& clock() = 0;
  virtual void Tick(int tick) = 0;  // time has moved on; the world shows tick `tick`
};

struct ContractCase {
  std::string name;
  std::function<std::unique_ptr<ContractRig>()> rig;
  std::vector<Cause> causes;  // one of these during the trouble
  bool at_once;               // from the first tick of it, else after kStale
  bool names_fault;           // Fault() says something meanwhile
  int recovery_ticks;         // good again at the latest this long after it
};

class SampleSourceContract : public testing::TestWithParam<ContractCase> {};

TEST_P(SampleSourceContract, Holds) {
  const ContractCase& c = GetParam();
  const std::unique_ptr<ContractRig> rig = c.rig();
  SampleSource& source = rig->source();
  ASSERT_EQ(source.channels().size(), 2u);
  EXPECT_EQ(source.channels()[0].name, "probe_a_um");
  EXPECT_EQ(source.channels()[1].name, "probe_b_um");

  std::vector<Sample> before(2);
  std::uint64_t set_before = 0;
  bool named_fault = false;
  for (int tick = 0; tick < kTicks; ++tick) {
    rig->Tick(tick);
    const SampleSet set = source.Read();
    ASSERT_EQ(set.samples.size(), 2u);
    EXPECT_GT(set.sequence, set_before);
    set_before = set.sequence;
    const bool trouble = tick >= kTroubleFrom && tick < kTroubleTo;
    named_fault = named_fault || (trouble && !source.Fault().empty());
    for (std::size_t i = 0; i < 2; ++i) {
      const Sample& sample = set.samples[i];
      SCOPED_TRACE(testing::Message() << "tick " << tick << " channel " << i << " is "
                                      << NameOf(sample.quality) << ", " << NameOf(sample.cause));
      EXPECT_EQ(std::isnan(sample.value), sample.quality == Quality::kBad);
      EXPECT_EQ(sample.cause == Cause::kNone, sample.good());
      EXPECT_GE(sample.sequence, before[i].sequence);
      EXPECT_GE(sample.time_s, before[i].time_s);
      EXPECT_GE(sample.age_s, 0.0);
      if (sample.good()) {
        EXPECT_NEAR(sample.value, TrueWord(i, tick) * kStep, 1e-9);
        EXPECT_GT(sample.sequence, before[i].sequence);
        EXPECT_LE(sample.age_s, kStale);
      }
      const bool must_be_bad =
          trouble && (c.at_once || (tick - kTroubleFrom) * kTick > kStale + kTick);
      if (must_be_bad) {
        EXPECT_EQ(sample.quality, Quality::kBad);
        EXPECT_NE(std::find(c.causes.begin(), c.causes.end(), sample.cause), c.causes.end());
      }
      if (tick < kTroubleFrom || tick >= kTroubleTo + c.recovery_ticks) {
        EXPECT_TRUE(sample.good());
      }
      before[i] = sample;
    }
  }
  EXPECT_EQ(named_fault, c.names_fault);
  EXPECT_EQ(source.Fault().empty(), !source.Ended());
}

inline std::string CaseName(const testing::TestParamInfo<ContractCase>& info) {
  return info.param.name;
}

}  // namespace abbe::hal
