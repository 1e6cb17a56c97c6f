// The contract on the siblings that need no device: fake, replay, combined.
#include "sample_source_contract.h"

#include <limits>

#include "hal/combined_source.h"
#include "hal/modbus/fake_source.h"
#include "hal/replay_source.h"

namespace abbe::hal {
namespace sample_source_contract_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

int TickAt(double time_s) { return static_cast<int>(std::lround(time_s / kTick)) - 1; }

double Truth(const std::string& channel, double time_s) {
  return TrueWord(channel == "probe_a_um" ? 0 : 1, TickAt(time_s)) * kStep;
}

FakeFault FaultOf(Trouble trouble) {
  using Kind = FakeFault::Kind;
  FakeFault fault;
  fault.kind = trouble == Trouble::kLost        ? Kind::kLost
               : trouble == Trouble::kLate      ? Kind::kLate
               : trouble == Trouble::kDoubled   ? Kind::kDoubled
               : trouble == Trouble::kRefused   ? Kind::kRefused
               : trouble == Trouble::kFrozen    ? Kind::kFrozen
               : trouble == Trouble::kSaturated ? Kind::kSaturated
                                                : Kind::kSentinel;
  fault.late_s = 5.0;
  fault.from_s = (kTroubleFrom + 0.5) * kTick;
  fault.to_s = (kTroubleTo + 0.5) * kTick;
  return fault;
}

std::unique_ptr<FakeSource> Fake(Trouble trouble, Clock& clock, std::size_t first,
                                 std::size_t count) {
  auto channels = ContractChannels();
  // Saturated: without the sentinel at the converter's end, so that the maximum has to catch it.
  if (trouble == Trouble::kSaturated) channels[0].sentinels = channels[1].sentinels = {64000};
  const auto begin = channels.begin() + static_cast<std::ptrdiff_t>(first);
  auto source = std::make_unique<FakeSource>(
      std::vector<ChannelSettings>(begin, begin + static_cast<std::ptrdiff_t>(count)), Truth,
      kStale, clock);
  source->Inject(FaultOf(trouble));
  return source;
}

class HandRig : public ContractRig {
 public:
  SampleSource& source() override { return *source_; }
  Clock& clock() override { return clock_; }
  void Tick(int) override { clock_.Advance(kTick); }

 protected:
  HandClock clock_;
  std::unique_ptr<SampleSource> source_;
};

class FakeRig : public HandRig {
 public:
  explicit FakeRig(Trouble trouble) { source_ = Fake(trouble, clock_, 0, 2); }
};

class CombinedRig : public HandRig {
 public:
  explicit CombinedRig(Trouble trouble) {
    std::vector<std::unique_ptr<SampleSource>> parts;
    parts.push_back(Fake(trouble, clock_, 0, 1));
    parts.push_back(Fake(trouble, clock_, 1, 1));
    source_ = std::make_unique<CombinedSource>(std::move(parts), 0.02, clock_);
  }
};

class ReplayRig : public HandRig {
 public:
  explicit ReplayRig(recording::Flag flag) {
    recording::Recording recording;
    recording.name = "before.csv";
    recording.columns = {{"time_s", {}}, {"probe_a_um", {}}, {"probe_b_um", {}}, {"flags", {}}};
    for (int tick = 0; tick < kTicks; ++tick) {
      const bool trouble = tick >= kTroubleFrom && tick < kTroubleTo;
      recording.columns[0].values.push_back(3.0 + tick * kTick);
      for (std::size_t i = 0; i < 2; ++i) {
        recording.columns[1 + i].values.push_back(trouble ? kNan : TrueWord(i, tick) * kStep);
      }
      recording.columns[3].values.push_back(trouble ? static_cast<double>(flag) : 0.0);
    }
    source_ = std::make_unique<ReplaySource>(std::move(recording), clock_);
  }
  void Tick(int) override {}  // the rows move the clock
};

template <class Rig, class Way>
std::function<std::unique_ptr<ContractRig>()> Make(Way way) {
  return [way] { return std::make_unique<Rig>(way); };
}

std::vector<ContractCase> Cases() {
  std::vector<ContractCase> cases;
  const auto add = [&](const std::string& name, Trouble trouble, Cause cause, bool at_once,
                       bool fault) {
    cases.push_back({"Fake" + name, Make<FakeRig>(trouble), {cause}, at_once, fault, 0});
    cases.push_back({"Combined" + name, Make<CombinedRig>(trouble), {cause}, at_once, fault, 0});
  };
  add("Lost", Trouble::kLost, Cause::kNoReply, true, true);
  add("Late", Trouble::kLate, Cause::kStale, true, false);
  add("Doubled", Trouble::kDoubled, Cause::kStale, true, false);
  add("Refused", Trouble::kRefused, Cause::kRefused, true, true);
  add("Saturated", Trouble::kSaturated, Cause::kOutOfRange, true, false);
  add("Sentinel", Trouble::kSentinel, Cause::kSentinel, true, false);
  cases.push_back({"ReplayDeviceError",
                   Make<ReplayRig>(recording::kDeviceError),
                   {Cause::kNoReply},
                   true,
                   false,
                   0});
  cases.push_back({"ReplayOutOfRange",
                   Make<ReplayRig>(recording::kOutOfRange),
                   {Cause::kOutOfRange},
                   true,
                   false,
                   0});
  cases.push_back(
      {"ReplayStale", Make<ReplayRig>(recording::kStale), {Cause::kStale}, true, false, 0});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Siblings, SampleSourceContract, testing::ValuesIn(Cases()), CaseName);

// A frozen register looks well until it has stood for `stale`; the contract's truth changes at each
// tick, so the value itself is checked here instead.
TEST(FakeSource, AFrozenRegisterIsBadOnceItHasStoodForTooLong) {
  HandClock clock;
  const auto source = Fake(Trouble::kFrozen, clock, 0, 2);
  double changed_s = 0.0, value = 0.0;
  for (int tick = 0; tick < kTicks; ++tick) {
    clock.Advance(kTick);
    const Sample sample = source->Read().samples[0];
    if (tick == kTroubleFrom - 1) {
      changed_s = clock.Now();
      value = sample.value;
    }
    const bool trouble = tick >= kTroubleFrom && tick < kTroubleTo;
    // The tick at exactly `stale` may fall on either side by rounding.
    if (trouble && std::abs(clock.Now() - changed_s - kStale) < 0.5 * kTick) continue;
    const bool frozen = trouble && clock.Now() - changed_s > kStale;
    EXPECT_EQ(sample.good(), !frozen) << tick;
    if (frozen) {
      EXPECT_EQ(sample.cause, Cause::kFrozen);
      EXPECT_TRUE(std::isnan(sample.value));
    } else if (trouble) {
      EXPECT_EQ(sample.value, value);
    }
  }
}

TEST(FakeSource, AChannelThatMayFreezeStaysGood) {
  HandClock clock;
  auto channels = ContractChannels();
  channels[0].may_freeze = true;
  FakeSource source(
      channels, [](const std::string&, double) { return 50.0; }, kStale, clock);
  for (int tick = 0; tick < 30; ++tick) {
    clock.Advance(kTick);
    const SampleSet set = source.Read();
    EXPECT_TRUE(set.samples[0].good());
    EXPECT_EQ(set.samples[1].good(), tick <= 10) << tick;
  }
}

TEST(CombinedSource, MeasuresTheSkewAndRefusesASetThatIsTorn) {
  HandClock clock;
  const auto constant = [](const std::string& name, double time_s) {
    return (name == "probe_a_um" ? 50.0 : 60.0) + time_s;
  };
  const auto channels = ContractChannels();
  std::vector<std::unique_ptr<SampleSource>> parts;
  parts.push_back(std::make_unique<FakeSource>(std::vector<ChannelSettings>{channels[0]}, constant,
                                               kStale, clock));
  auto late = std::make_unique<FakeSource>(std::vector<ChannelSettings>{channels[1]}, constant,
                                           kStale, clock);
  late->Inject({.kind = FakeFault::Kind::kLate, .from_s = 1.0, .to_s = 2.0, .late_s = 0.01});
  late->Inject({.kind = FakeFault::Kind::kLate, .from_s = 2.0, .to_s = 3.0, .late_s = 0.05});
  parts.push_back(std::move(late));
  CombinedSource source(std::move(parts), 0.02, clock);
  const auto read_at = [&](double time_s) {
    clock.SleepUntil(time_s);
    return source.Read();
  };
  EXPECT_EQ(read_at(0.5).skew_s, 0.0);
  const SampleSet near = read_at(1.5);
  EXPECT_NEAR(near.skew_s, 0.01, 1e-12);
  EXPECT_NEAR(near.time_s, 1.495, 1e-12);
  EXPECT_TRUE(near.AllGood());
  const SampleSet torn = read_at(2.5);
  EXPECT_NEAR(torn.skew_s, 0.05, 1e-12);
  for (const Sample& sample : torn.samples) {
    EXPECT_EQ(sample.quality, Quality::kBad);
    EXPECT_EQ(sample.cause, Cause::kIncoherent);
    EXPECT_TRUE(std::isnan(sample.value));
  }
  EXPECT_TRUE(read_at(3.5).AllGood());
  EXPECT_NEAR(source.worst_skew_s(), 0.05, 1e-12);
}

recording::Recording Rows(const std::vector<double>& times, const std::vector<double>& a,
                          const std::vector<double>& b, const std::vector<double>& flags) {
  recording::Recording recording;
  recording.name = "r.csv";
  recording.columns = {{"time_s", times}, {"probe_a_um", a}, {"temp_c", b}, {"flags", flags}};
  return recording;
}

TEST(ReplaySource, TheClockDecidesThePace) {
  HandClock clock;
  clock.Advance(100.0);
  ReplaySource source(Rows({5, 5.5, 7}, {1, 2, 3}, {4, 5, 6}, {0, 0, 0}), clock);
  EXPECT_EQ(source.Read().time_s, 100.0);
  EXPECT_EQ(source.Read().time_s, 100.5);
  EXPECT_EQ(clock.Now(), 100.5);
  EXPECT_FALSE(source.Ended());
  EXPECT_EQ(source.Read().samples[1].value, 6.0);
  EXPECT_EQ(clock.Now(), 102.0);
  EXPECT_TRUE(source.Ended());
  EXPECT_FALSE(source.Read().samples[0].good());
  EXPECT_EQ(source.Fault(), "r.csv: the recording has ended");
}

TEST(ReplaySource, AFlagSpoilsWhatItMayMean) {
  HandClock clock;
  ReplaySource source(Rows({0, 1, 2, 3}, {kNan, 2, 3, 4}, {5, 6, 7, 8}, {2, 2, 8, 16}), clock);
  const SampleSet one_is_nan = source.Read();
  EXPECT_EQ(one_is_nan.samples[0].cause, Cause::kOutOfRange);
  EXPECT_TRUE(one_is_nan.samples[1].good());
  const SampleSet none_is_nan = source.Read();
  EXPECT_EQ(none_is_nan.samples[0].cause, Cause::kOutOfRange);
  EXPECT_EQ(none_is_nan.samples[1].quality, Quality::kBad);
  const SampleSet interpolated = source.Read();
  EXPECT_EQ(interpolated.samples[0].quality, Quality::kUncertain);
  EXPECT_EQ(interpolated.samples[0].cause, Cause::kInterpolated);
  EXPECT_EQ(interpolated.samples[0].value, 3.0);
  EXPECT_EQ(source.Read().samples[1].cause, Cause::kClockJump);
}

}  // namespace sample_source_contract_test
}  // namespace abbe::hal
