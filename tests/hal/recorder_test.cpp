// The recorder on scripted sources and a hand clock.
#include "hal/recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "failure/failure.h"

namespace abbe::hal {
namespace recorder_test {

class MemoryWriter : public recording::Writer {
 public:
  void Append(std::span<const double> row) override {
    if (rows.size() == full_at) throw DeviceError("memory.csv: disk full");
    rows.emplace_back(row.begin(), row.end());
  }
  void Flush() override {}
  void Close() override { closed = true; }

  std::vector<std::vector<double>> rows;
  std::size_t full_at = 1'000'000;
  bool closed = false;
};

// A probe, and 2 ms later an encoder, which fails in every fifth set.
class ProbeAndEncoder : public SampleSource {
 public:
  explicit ProbeAndEncoder(Clock& clock) : clock_(clock) {}
  const std::vector<Channel>& channels() const override { return channels_; }
  SampleSet Read() override {
    SampleSet set;
    set.sequence = ++reads;
    const double now = clock_.Now();
    set.samples.push_back(Sample::Good(100.0, now, reads));
    clock_.SleepUntil(now + 2e-3);
    set.samples.push_back(reads % 5 == 0 ? Sample::Bad(Cause::kNoReply, now + 2e-3, reads)
                                         : Sample::Good(0.5, now + 2e-3, reads));
    FinishSet(set, clock_.Now());
    return set;
  }
  bool Ended() const override { return reads == end_after; }

  std::uint64_t reads = 0, end_after = 1'000'000;

 private:
  Clock& clock_;
  std::vector<Channel> channels_{{"probe_a_um", "head"}, {"pivot_1_rad", "linkage"}};
};

TEST(Recorder, WritesProbesAndEncodersWithTheirSkew) {
  HandClock clock;
  clock.Advance(3.0);
  ProbeAndEncoder source(clock);
  MemoryWriter writer;
  const RecordOutcome outcome = Record(source, clock, writer, {.rate = 100.0, .seconds = 1.0});
  // 100 Hz for one second, begun at its start; whether the last falls on its end is rounding.
  EXPECT_NEAR(static_cast<double>(outcome.rows), 100.0, 1.0);
  ASSERT_EQ(writer.rows.size(), outcome.rows);
  EXPECT_TRUE(writer.closed);
  double before_s = -1.0;
  for (std::size_t i = 0; i < writer.rows.size(); ++i) {
    const auto& row = writer.rows[i];
    ASSERT_EQ(row.size(), RecordColumns(source.channels()).size());
    EXPECT_GT(row[0], before_s);
    before_s = row[0];
    EXPECT_EQ(row[1], 100.0);
    const bool failed = (i + 1) % 5 == 0;
    EXPECT_EQ(std::isnan(row[2]), failed);
    EXPECT_NEAR(row[3], failed ? 0.0 : 2.0, 1e-9);
    EXPECT_EQ(row[4], failed ? 4.0 : 0.0);
  }
  EXPECT_EQ(outcome.flagged, outcome.rows / 5);
  EXPECT_NEAR(outcome.worst_skew_s, 2e-3, 1e-12);
  EXPECT_NEAR(outcome.mean_skew_s, 1.6e-3, 2e-5);
  EXPECT_EQ(outcome.worst_channel,
            "pivot_1_rad was bad in " + std::to_string(outcome.flagged) + " rows, last: no reply");
}

TEST(Recorder, EndsWhenToldAndWhenTheSourceHasEnded) {
  HandClock clock;
  ProbeAndEncoder source(clock);
  MemoryWriter writer;
  EXPECT_EQ(Record(source, clock, writer, {.stopped = [&] { return source.reads == 7; }}).rows, 7u);
  source.end_after = 10;
  EXPECT_EQ(Record(source, clock, writer, {}).rows, 3u);
}

// The controller says 0, 0, 1, 1, nothing, 2, 0 and so on.
class Controller : public SampleSource {
 public:
  explicit Controller(Clock& clock) : clock_(clock) {}
  const std::vector<Channel>& channels() const override { return channels_; }
  SampleSet Read() override {
    SampleSet set;
    set.sequence = ++reads_;
    const double pass = passes_[(reads_ - 1) % passes_.size()];
    set.samples.push_back(Sample::Good(7.0, clock_.Now(), reads_));
    set.samples.push_back(std::isnan(pass) ? Sample::Bad(Cause::kNoReply, clock_.Now(), reads_)
                                           : Sample::Good(pass, clock_.Now(), reads_));
    FinishSet(set, clock_.Now());
    return set;
  }
  bool Ended() const override { return reads_ == 2 * passes_.size(); }

 private:
  Clock& clock_;
  std::uint64_t reads_ = 0;
  std::vector<double> passes_{0.0, 0.0, 1.0, 1.0, NAN, 2.0, 0.0};
  std::vector<Channel> channels_{{"x_mm", "machine"}, {"pass", "machine"}};
};

// A row of which nobody knows whether it belongs to a pass is kept, with its flag.
TEST(Recorder, LeavesOutTheWayBetweenPassesWhenAsked) {
  for (const bool passes_only : {false, true}) {
    HandClock clock;
    Controller source(clock);
    MemoryWriter writer;
    const RecordOutcome outcome = Record(source, clock, writer, {.passes_only = passes_only});
    ASSERT_EQ(outcome.rows, passes_only ? 8u : 14u);
    EXPECT_EQ(outcome.flagged, 2u);
    std::vector<double> passes;
    for (const auto& row : writer.rows) passes.push_back(row.back() != 0.0 ? -1.0 : row[2]);
    if (!passes_only) continue;
    EXPECT_EQ(passes, (std::vector<double>{1.0, 1.0, -1.0, 2.0, 1.0, 1.0, -1.0, 2.0}));
  }
}

TEST(Recorder, ClosesTheFileWhenTheDiskIsFull) {
  HandClock clock;
  ProbeAndEncoder source(clock);
  MemoryWriter writer;
  writer.full_at = 4;
  EXPECT_THROW(Record(source, clock, writer, {}), DeviceError);
  EXPECT_TRUE(writer.closed);
}

TEST(Recorder, TheKindFollowsFromTheChannels) {
  const auto kind = [](const std::vector<std::string>& names) {
    std::vector<Channel> channels;
    channels.reserve(names.size());
    for (const std::string& name : names) channels.push_back({name, "d"});
    return KindOf(channels);
  };
  EXPECT_EQ(kind({"pivot_1_rad", "x_mm", "y_mm", "z_mm"}), "linkage");
  EXPECT_EQ(kind({"pivot_1_rad", "x_mm", "y_mm"}), "dwell");
  EXPECT_EQ(kind({"x_mm", "ref_x_mm"}), "reference");
  EXPECT_EQ(kind({"probe_a_um", "x_mm", "y_mm", "z_mm"}), "dwell");
}

TEST(Recorder, TheHeaderTellsTheSources) {
  HandClock clock;
  const ProbeAndEncoder source(clock);
  EXPECT_EQ(
      RecordHeader(
          {"mill \"2\"", "2026-11-21T09:00:00Z", {{"head", "modbus"}, {"linkage", "canopen"}}},
          source.channels()),
      "kind = \"dwell\"\nmachine = \"mill \\\"2\\\"\"\nstarted = 2026-11-21T09:00:00Z\n"
      "[sources]\n\"head\" = \"modbus: probe_a_um\"\n\"linkage\" = \"canopen: pivot_1_rad\"\n");
}

}  // namespace recorder_test
}  // namespace abbe::hal
