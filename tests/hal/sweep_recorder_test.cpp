// The recorder on a fake source and a hand clock: sweeps of minutes in milliseconds.
#include "hal/sweep_recorder.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <limits>
#include <set>

#include "hal/modbus/fake_source.h"
#include "hal/replay_source.h"
#include "hal/sweep_follower.h"
#include "swept_machine.h"

namespace abbe::hal {
namespace sweep_recorder_test {

enum Column { kTime, kX, kY, kZ, kPass, kDirection, kFeed, kProbe, kFlags };

class MemoryWriter : public recording::Writer {
 public:
  void Append(std::span<const double> row) override {
    if (rows.size() == full_at) throw DeviceError("memory.csv: disk full");
    rows.emplace_back(row.begin(), row.end());
  }
  void Flush() override {}
  void Close() override { closed = true; }

  std::vector<std::vector<double>> rows;
  std::size_t full_at = std::numeric_limits<std::size_t>::max();
  bool closed = false;
};

std::vector<ChannelSettings> SweepChannels() {
  ChannelSettings probe;
  probe.name = "probe_a_um";
  probe.scale = 0.003;
  ChannelSettings axis;
  axis.name = "x_mm";
  axis.type = WordType::kInt32;
  axis.scale = 1e-5;
  axis.may_freeze = true;
  return {probe, axis};
}

class SweepRecorderTest : public testing::Test {
 protected:
  explicit SweepRecorderTest(double from = 0.002)
      : machine_(plan_, from, 1.0), source_(SweepChannels(), Truth(), 1.0, clock_) {}

  FakeSource::Truth Truth() {
    return [this](const std::string& channel, double time_s) {
      if (channel == "x_mm") return 1e3 * machine_.PositionAt(time_s);
      return 100.0 + std::sin(37.0 * time_s);
    };
  }
  SweepOutcome Record(const SweepOptions& options = {}) {
    return RecordSweep(source_, plan_, clock_, writer_, options);
  }
  // Rows that were written while the machine stood there.
  std::vector<std::vector<double>> RowsOf(const SweptMachine::Stand& stand) const {
    std::vector<std::vector<double>> rows;
    for (const auto& row : writer_.rows) {
      if (row[kTime] >= stand.from_s && row[kTime] <= stand.to_s) rows.push_back(row);
    }
    return rows;
  }

  SweepPlan plan_ = SmallPlan();
  SweptMachine machine_;
  HandClock clock_;
  FakeSource source_;
  MemoryWriter writer_;
};

TEST_F(SweepRecorderTest, RecordsEveryStationFromBothSidesInEveryPass) {
  std::vector<std::size_t> progress;
  const SweepOutcome outcome = Record({.progress = [&](const SweepProgress& p) {
    progress.push_back(p.visits_done);
    EXPECT_EQ(p.visits_total, 12u);
    EXPECT_EQ(p.fault, "");
  }});
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  EXPECT_TRUE(outcome.lacking.empty());
  EXPECT_EQ(outcome.flagged, 0u);
  EXPECT_EQ(outcome.rows, writer_.rows.size());
  EXPECT_TRUE(writer_.closed);
  EXPECT_EQ(progress.size(), 12u);
  EXPECT_EQ(progress.back(), 12u);
  ASSERT_EQ(machine_.stands().size(), 12u);
  for (const SweptMachine::Stand& stand : machine_.stands()) {
    const auto rows = RowsOf(stand);
    // 200 Hz; the recorder ends the last dwell where the plan does.
    EXPECT_GE(rows.size(), static_cast<std::size_t>(200 * (plan_.settle + plan_.dwell)) - 1);
    for (const auto& row : rows) {
      EXPECT_EQ(row[kPass], stand.visit.pass);
      EXPECT_EQ(row[kDirection], stand.visit.direction);
      EXPECT_NEAR(row[kX], 1e3 * plan_.stations[stand.visit.station], 1e-5);
      EXPECT_EQ(row[kFlags], 0.0);
    }
  }
}

TEST_F(SweepRecorderTest, WritesMotionTooAndNothingBeforeTheFirstPass) {
  Record();
  double before = -1.0;
  std::size_t moving = 0;
  for (const auto& row : writer_.rows) {
    EXPECT_GT(row[kTime], before);
    before = row[kTime];
    EXPECT_GE(row[kPass], 1.0);
    EXPECT_EQ(std::abs(row[kDirection]), 1.0);
    EXPECT_NEAR(row[kFeed], 600.0, 1e-9);
    EXPECT_EQ(row[kY], 0.0);
    moving += row[kX] > 1.1 && row[kX] < 2.9 ? 1 : 0;
  }
  EXPECT_GT(moving, 4 * 30u);  // 1.8 mm at 10 mm/s and 200 Hz, four times
}

TEST_F(SweepRecorderTest, ADeviceThatIsAwayCostsFlaggedRowsAndTheVisitsItMissed) {
  const auto& stands = machine_.stands();
  source_.Inject({.kind = FakeFault::Kind::kLost,
                  .from_s = stands[3].from_s - 0.01,
                  .to_s = stands[4].to_s + 0.01});
  std::set<std::string> faults;
  const SweepOutcome outcome =
      Record({.progress = [&](const SweepProgress& p) { faults.insert(p.fault); }});
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  ASSERT_EQ(outcome.lacking.size(), 2u);
  EXPECT_EQ(outcome.lacking[0].station, 2u);
  EXPECT_EQ(outcome.lacking[0].direction, -1);
  EXPECT_EQ(outcome.lacking[1].station, 1u);
  EXPECT_EQ(outcome.lacking[1].pass, 1);
  EXPECT_EQ(faults, (std::set<std::string>{"", "device \"fake\": no answer"}));
  std::uint64_t flagged = 0;
  for (const auto& row : writer_.rows) {
    EXPECT_EQ(std::isnan(row[kProbe]), row[kFlags] != 0.0);
    EXPECT_EQ(std::isnan(row[kX]), row[kFlags] != 0.0);
    if (row[kFlags] != 0.0) {
      EXPECT_EQ(row[kFlags], 4.0);
      ++flagged;
    }
  }
  EXPECT_EQ(flagged, outcome.flagged);
  EXPECT_GT(flagged, 200u);
  for (std::size_t i = 5; i < stands.size(); ++i) {
    for (const auto& row : RowsOf(stands[i])) EXPECT_EQ(row[kPass], stands[i].visit.pass);
  }
}

TEST_F(SweepRecorderTest, ALinkLostAtTheTurnCostsNoPass) {
  const auto& stands = machine_.stands();
  source_.Inject({.kind = FakeFault::Kind::kLost,  // last station of pass 1 to first of pass 2
                  .from_s = stands[5].from_s - 0.01,
                  .to_s = stands[6].to_s + 0.01});
  const SweepOutcome outcome = Record();
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  EXPECT_EQ(outcome.lacking.size(), 2u);
  for (const auto& row : RowsOf(stands[7])) EXPECT_EQ(row[kPass], 2.0);
}

TEST_F(SweepRecorderTest, ASaturatedProbeLeavesTheOtherColumnsAlone) {
  ChannelSettings probe = SweepChannels()[0];
  probe.maximum = 150.0;
  FakeSource source({probe, SweepChannels()[1]}, Truth(), 1.0, clock_);
  source.Inject(
      {.kind = FakeFault::Kind::kSaturated, .from_s = 2.0, .to_s = 3.0, .channel = "probe_a_um"});
  const SweepOutcome outcome = RecordSweep(source, plan_, clock_, writer_, {});
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  EXPECT_GT(outcome.flagged, 190u);
  for (const auto& row : writer_.rows) {
    const bool bad = row[kTime] >= 2.0 && row[kTime] < 3.0;
    EXPECT_EQ(row[kFlags], bad ? 2.0 : 0.0) << row[kTime];
    EXPECT_EQ(std::isnan(row[kProbe]), bad);
    EXPECT_FALSE(std::isnan(row[kX]));
  }
}

TEST_F(SweepRecorderTest, StopsCleanlyWhenAsked) {
  const SweepOutcome outcome = Record({.stopped = [this] { return clock_.Now() > 4.0; }});
  EXPECT_EQ(outcome.end, SweepEnd::kStopped);
  EXPECT_TRUE(writer_.closed);
  EXPECT_NEAR(writer_.rows.back()[kTime], 4.0, 0.02);
  EXPECT_FALSE(outcome.lacking.empty());
  EXPECT_LT(outcome.lacking.size(), 12u);
}

TEST_F(SweepRecorderTest, AMachineThatNeverMovesIsADeviceError) {
  FakeSource still(
      SweepChannels(), [](const std::string&, double) { return 7.0; }, 100.0, clock_);
  try {
    RecordSweep(still, plan_, clock_, writer_, {});
    FAIL() << "returned";
  } catch (const DeviceError& error) {
    EXPECT_STREQ(error.what(),
                 "the X axis did not move for 5 s; start the machine's program and try again");
  }
  EXPECT_TRUE(writer_.closed);
  EXPECT_TRUE(writer_.rows.empty());
}

TEST_F(SweepRecorderTest, ADeviceThatNeverAnswersIsNamed) {
  source_.Inject({.kind = FakeFault::Kind::kLost});
  try {
    Record();
    FAIL() << "returned";
  } catch (const DeviceError& error) {
    EXPECT_STREQ(error.what(),
                 "the X axis did not move for 5 s (device \"fake\": no answer); start "
                 "the machine's program and try again");
  }
}

TEST_F(SweepRecorderTest, AMachineThatStopsHalfWayEndsTheSweepWithItsData) {
  const double stop_s = machine_.stands()[7].from_s + 0.2;
  FakeSource halting(
      SweepChannels(),
      [&](const std::string& channel, double time_s) {
        return Truth()(channel, channel == "x_mm" ? std::min(time_s, stop_s) : time_s);
      },
      1.0, clock_);
  const SweepOutcome outcome = RecordSweep(halting, plan_, clock_, writer_, {});
  EXPECT_EQ(outcome.end, SweepEnd::kStandstill);
  EXPECT_EQ(outcome.lacking.size(), 4u);  // the visit at which it stopped had its dwell
  EXPECT_TRUE(writer_.closed);
}

TEST_F(SweepRecorderTest, AFullDiskPassesThrough) {
  writer_.full_at = 100;
  EXPECT_THROW(Record(), DeviceError);
  EXPECT_EQ(writer_.rows.size(), 100u);
  EXPECT_TRUE(writer_.closed);
}

TEST_F(SweepRecorderTest, WithoutAPositionTheOperatorIsAsked) {
  FakeSource probe_only({SweepChannels()[0]}, Truth(), 1.0, clock_);
  EXPECT_THROW(RecordSweep(probe_only, plan_, clock_, writer_, {}), InputError);
  std::vector<Visit> asked;
  const SweepOutcome outcome =
      RecordSweep(probe_only, plan_, clock_, writer_,
                  {.rest = {0.0, 0.25, 0.0}, .prompt = [&](const Visit& visit) {
                     asked.push_back(visit);
                     clock_.Advance(3.0);  // the operator moves the axis
                     return true;
                   }});
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  EXPECT_TRUE(outcome.lacking.empty());
  const auto plan = plan_.Visits();
  ASSERT_EQ(asked.size(), plan.size());
  std::vector<std::size_t> rows(plan.size());
  for (const auto& row : writer_.rows) {
    // Visit i is asked for after i waits and dwells.
    const auto i =
        static_cast<std::size_t>(row[kTime] / (3.0 + plan_.settle + plan_.dwell + 0.005));
    ASSERT_LT(i, plan.size());
    EXPECT_EQ(row[kX], 1e3 * plan_.stations[plan[i].station]);
    EXPECT_EQ(row[kDirection], plan[i].direction);
    EXPECT_EQ(row[kPass], plan[i].pass);
    EXPECT_EQ(row[kY], 250.0);
    ++rows[i];
  }
  for (const std::size_t count : rows) EXPECT_GE(count, 120u);  // 0.6 s at 200 Hz
}

TEST_F(SweepRecorderTest, TheOperatorMayEndIt) {
  int asked = 0;
  FakeSource probe_only({SweepChannels()[0]}, Truth(), 1.0, clock_);
  const SweepOutcome outcome = RecordSweep(probe_only, plan_, clock_, writer_,
                                           {.prompt = [&](const Visit&) { return ++asked < 3; }});
  EXPECT_EQ(outcome.end, SweepEnd::kStopped);
  EXPECT_EQ(outcome.lacking.size(), 10u);
  EXPECT_TRUE(writer_.closed);
}

TEST_F(SweepRecorderTest, AnOperatorWhoStandsElsewhereIsAskedAgain) {
  double x_mm = 0.0;
  FakeSource source(
      SweepChannels(),
      [&](const std::string& channel, double time_s) {
        return channel == "x_mm" ? x_mm : Truth()(channel, time_s);
      },
      1.0, clock_);
  std::size_t asked = 0;
  std::vector<std::string> why;
  const SweepOutcome outcome =
      RecordSweep(source, plan_, clock_, writer_,
                  {.prompt =
                       [&](const Visit& visit) {
                         clock_.Advance(3.0);
                         x_mm = 1e3 * plan_.stations[visit.station] + (asked == 4 ? 12.0 : 0.0);
                         return ++asked < 100;
                       },
                   .refused = [&](const std::string& text) { why.push_back(text); }});
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  EXPECT_TRUE(outcome.lacking.empty());
  EXPECT_EQ(asked, plan_.Visits().size() + 1);
  ASSERT_EQ(why.size(), 1u);
  EXPECT_EQ(why[0].substr(0, 11), "X stands at");
  for (const auto& row : writer_.rows) EXPECT_LT(row[kX], 1e3 * plan_.last() + 1.0);
}

// SIGSTOP, a laptop's lid: SleepUntil returns 0.8 s late, three times.
class SuspendedClock : public HandClock {
 public:
  void SleepUntil(double time_s) override {
    HandClock::SleepUntil(time_s);
    if (Now() < next_ || ++suspensions_ > 3) return;
    Advance(0.8);
    next_ = Now() + 1.0;
  }
  double next_ = 1.0;
  int suspensions_ = 0;
};

TEST(SweepRecorder, FlagsTheRowBeforeWhichItWasSuspended) {
  const SweepPlan plan = SmallPlan();
  const SweptMachine machine(plan, 0.002, 1.0);
  SuspendedClock clock;
  FakeSource source(
      SweepChannels(),
      [&](const std::string& channel, double time_s) {
        return channel == "x_mm" ? 1e3 * machine.PositionAt(time_s)
                                 : 100.0 + std::sin(37.0 * time_s);
      },
      1.0, clock);
  MemoryWriter writer;
  const SweepOutcome outcome = RecordSweep(source, plan, clock, writer, {});
  EXPECT_EQ(outcome.end, SweepEnd::kComplete);
  std::size_t jumps = 0;
  for (std::size_t i = 1; i < writer.rows.size(); ++i) {
    const double gap = writer.rows[i][kTime] - writer.rows[i - 1][kTime];
    EXPECT_EQ(writer.rows[i][kFlags], gap > 0.1 ? 16.0 : 0.0) << i;
    EXPECT_FALSE(std::isnan(writer.rows[i][kProbe]));  // the reading itself is whole
    jumps += gap > 0.1 ? 1 : 0;
  }
  EXPECT_GE(jumps, 2u);  // one may lie before the first pass
}

TEST_F(SweepRecorderTest, AReplayedSweepIsRecordedAgainAsItWas) {
  Record();
  recording::Recording recording;
  recording.name = "first.csv";
  const auto names = SweepColumns(source_.channels());
  for (std::size_t c = 0; c < names.size(); ++c) {
    recording.columns.push_back({names[c], {}});
    for (const auto& row : writer_.rows) recording.columns[c].values.push_back(row[c]);
  }
  HandClock clock;
  ReplaySource replay(std::move(recording), clock);
  MemoryWriter again;
  const SweepOutcome outcome = RecordSweep(replay, plan_, clock, again, {});
  EXPECT_TRUE(outcome.lacking.empty());
  // The follower needs two windows of motion to see the first pass begin; from there all is the
  // same.
  ASSERT_GT(again.rows.size() + 10, writer_.rows.size());
  const std::size_t skipped = writer_.rows.size() - again.rows.size();
  for (std::size_t i = 0; i < again.rows.size(); ++i) {
    for (const Column column : {kX, kPass, kDirection, kProbe, kFlags}) {
      EXPECT_EQ(again.rows[i][column], writer_.rows[i + skipped][column]) << i;
    }
  }
}

// Counts instead of keeping.
class CountingWriter : public recording::Writer {
 public:
  void Append(std::span<const double>) override { ++rows; }
  void Flush() override {}
  void Close() override {}
  std::size_t rows = 0;
};

TEST_F(SweepRecorderTest, MemoryDoesNotGrowWithTheLength) {
  plan_.idle = 1e9;
  CountingWriter writer;
  std::size_t early = 0, late = 0;
  const SweepOutcome outcome =
      RecordSweep(source_, plan_, clock_, writer, {.rate = 2e4, .stopped = [&] {
                                                     if (writer.rows == 1000)
                                                       early = mallinfo2().uordblks;
                                                     if (writer.rows == 100'000)
                                                       late = mallinfo2().uordblks;
                                                     return writer.rows > 100'000;
                                                   }});
  EXPECT_GT(outcome.rows, 100'000u);
  EXPECT_LT(late, early + 4096);  // 99,000 rows of 9 numbers would be 7 MB
}

// What the controller says of its program is no part of a sweep: the sweep follows the axis.
TEST_F(SweepRecorderTest, TellsPassDirectionAndFeedByItself) {
  std::vector<ChannelSettings> channels = SweepChannels();
  for (const char* name : {"feed_mm_min", "pass", "direction"}) {
    ChannelSettings channel;
    channel.name = name;
    channel.may_freeze = true;
    channels.insert(channels.begin() + 1, channel);
  }
  FakeSource source(
      channels,
      [this](const std::string& channel, double time_s) {
        const bool own = channel == "pass" || channel == "direction" || channel == "feed_mm_min";
        return own ? 7.0 : Truth()(channel, time_s);
      },
      1.0, clock_);
  EXPECT_EQ(SweepColumns(source.channels()), SweepColumns(source_.channels()));
  EXPECT_EQ(RecordSweep(source, plan_, clock_, writer_, {}).end, SweepEnd::kComplete);
  ASSERT_FALSE(writer_.rows.empty());
  for (const auto& row : writer_.rows) {
    EXPECT_LE(row[kPass], plan_.passes);
    EXPECT_EQ(std::abs(row[kDirection]), 1.0);
    EXPECT_NEAR(row[kFeed], plan_.feed * 60e3, 1e-9);
    EXPECT_NEAR(row[kProbe], 100.0, 1.01);
  }
}

TEST(SweepHeader, IsTomlThatStatesThePlan) {
  const SweepPlan plan = SmallPlan();
  const std::string header =
      SweepHeader(plan,
                  {.machine = "my \"mill\"",
                   .started = "2026-11-21T09:00:00Z",
                   .source = "modbus",
                   .more = "[mounting]\nhead = \"0deg\"\n"},
                  {{"probe_a_um", "head"}, {"x_mm", "machine"}, {"y_mm", "machine"}});
  const auto root = settings::Document::Parse(header, "header").Root();
  EXPECT_EQ(root.Text("kind"), "sweep");
  EXPECT_EQ(root.Text("machine"), "my \"mill\"");
  EXPECT_EQ(root.Text("axis"), "X");
  EXPECT_EQ(root.Child("sources").Text("head"), "modbus: probe_a_um");
  EXPECT_EQ(root.Child("sources").Text("machine"), "modbus: x_mm, y_mm");
  const auto sweep = root.Child("sweep");
  EXPECT_EQ(sweep.Quantities("stations_mm", 3), plan.stations);
  EXPECT_DOUBLE_EQ(sweep.Quantity("window_um"), plan.window);
  EXPECT_DOUBLE_EQ(sweep.Quantity("feed_mm_min"), plan.feed);
  EXPECT_EQ(root.Child("mounting").Text("head"), "0deg");
}

TEST(SweepColumns, AreThoseOfASweepRecording) {
  const auto columns = SweepColumns({{"probe_a_um", "h"}, {"x_mm", "m"}, {"temp_table_c", "m"}});
  EXPECT_EQ(columns,
            (std::vector<std::string>{"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction",
                                      "feed_mm_min", "probe_a_um", "temp_table_c", "flags"}));
}

// The follower, fed by machines that do not keep to the plan.
struct Feed {
  SweepFollower follower;
  double time_s = 0.0, position = 0.0;
  explicit Feed(const SweepPlan& plan, double from) : follower(plan), position(from) { Stay(0.1); }
  const SweepState& Go(double to) {
    const double step = to > position ? 5e-5 : -5e-5;
    while (std::abs(to - position) > 5e-5) {
      position += step;
      follower.Step(position, time_s += 0.005, true);
    }
    position = to;
    return follower.Step(position, time_s += 0.005, true);
  }
  const SweepState& Stay(double seconds) {
    const double end = time_s + seconds;
    while (time_s < end) follower.Step(position, time_s += 0.005, true);
    return follower.Step(position, time_s += 0.005, true);
  }
};

TEST(SweepFollower, JoggingBeforeAndInsideThePassesCostsNone) {
  Feed feed(SmallPlan(), 0.0015);
  EXPECT_EQ(feed.Go(0.002).pass, 0);
  feed.Go(0.001);
  EXPECT_EQ(feed.Go(0.0012).pass, 1);  // a pass may begin anywhere below the middle
  feed.Go(-0.0005);
  EXPECT_EQ(feed.Go(0.001).pass, 1);
  feed.Go(0.0005);
  EXPECT_EQ(feed.Go(0.003).pass, 1);
  feed.Go(0.0025);
  feed.Go(0.0035);
  EXPECT_EQ(feed.Go(0.001).direction, -1);
  feed.Go(-0.0005);
  EXPECT_EQ(feed.Go(0.0).pass, 2);
}

TEST(SweepFollower, OvershootOfAServoIsNoTurn) {
  Feed feed(SmallPlan(), -0.0005);
  feed.Go(0.001 + 15e-6);
  EXPECT_EQ(feed.Go(0.001).direction, 1);
  const SweepState& state = feed.Stay(0.2);
  EXPECT_EQ(state.station, 1u);
  EXPECT_TRUE(state.settled);
}

TEST(SweepFollower, PassingThroughAStationIsNoVisit) {
  Feed feed(SmallPlan(), -0.0005);
  feed.Go(0.0035);
  EXPECT_EQ(feed.follower.visits_done(), 0u);
  EXPECT_EQ(feed.follower.Lacking().size(), 12u);
}

}  // namespace sweep_recorder_test
}  // namespace abbe::hal
