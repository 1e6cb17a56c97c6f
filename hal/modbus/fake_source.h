// A device that exists only in the program and fails on demand, for tests and rehearsals.
//
// Its readings go through the same registers and the same ChannelJudge as those of a Modbus device:
// `truth` is encoded by the settings of the channel, and a fault acts on the words or on the
// exchange.
//
//   FakeSource source(
//       channels, [](const std::string&, double t) { return 50 + std::sin(t); }, 1.0, clock);
//   source.Inject({.kind = FakeFault::Kind::kFrozen,
//                  .from_s = 10, .to_s = 20, .channel = "probe_c_um"});
//
// Units: that of each channel; s of the clock.
// Failure: none; what goes wrong is what was injected.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/modbus/channel_judge.h"
#include "hal/sample_source.h"

namespace abbe::hal {

struct FakeFault {
  enum class Kind {
    kLost,       // no reply
    kLate,       // measured `late_s` before it is returned
    kDoubled,    // the previous reading again
    kCorrupt,    // a reply that fails its check
    kRefused,    // an exception
    kFrozen,     // the register stands still
    kSaturated,  // the converter at its end, or beyond the channel's maximum
    kSentinel,   // the channel's first sentinel
  };
  Kind kind = Kind::kLost;
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  std::string channel = {};  // empty: all
  double late_s = 0.0;
};

class FakeSource : public SampleSource {
 public:
  // The value of a channel at a time, in the unit of its name.
  using Truth = std::function<double(const std::string& channel, double time_s)>;

  // `at` of the channels is not used. `clock` must outlive the source.
  FakeSource(std::vector<ChannelSettings> channels, Truth truth, double stale_s, Clock& clock,
             const std::string& name = "fake");

  // Adds to the faults before.
  void Inject(const FakeFault& fault) { faults_.push_back(fault); }
  // Ends all of them.
  void Heal() { faults_.clear(); }

  const std::vector<Channel>& channels() const override { return channels_; }
  // At the time of the clock.
  SampleSet Read() override;
  // As the last Read() left it.
  std::string Fault() const override { return fault_; }

 private:
  using Words = std::array<std::uint16_t, 2>;
  struct Reading {
    Words words{};
    double time_s = 0.0;
  };
  const FakeFault* Find(const std::string& channel, double now_s) const;
  Sample ReadChannel(std::size_t at, double now_s);

  std::vector<ChannelSettings> settings_;
  Truth truth_;
  Clock& clock_;
  std::vector<Channel> channels_;
  std::vector<ChannelJudge> judges_;
  std::vector<Reading> last_;
  std::vector<FakeFault> faults_;
  std::uint64_t sequence_ = 0;
  std::string fault_;
};

}  // namespace abbe::hal
