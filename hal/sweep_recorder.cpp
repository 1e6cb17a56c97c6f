#include "hal/sweep_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "hal/pace.h"
#include "hal/sample_row.h"
#include "hal/sweep_follower.h"
#include "settings/unit.h"

namespace abbe::hal {
namespace {

using settings::kMillimetre;

constexpr std::size_t kTime = 0, kX = 1, kPass = 4, kDirection = 5, kFeed = 6, kFirstReading = 7;
constexpr std::array<std::string_view, 3> kOwn = {"pass", "direction", "feed_mm_min"};

// The column of each channel.
std::vector<std::size_t> ColumnsOf(const std::vector<Channel>& channels) {
  std::vector<std::size_t> columns;
  std::size_t column = kFirstReading;
  for (const Channel& channel : channels) {
    // The controller's own pass, direction and feed are replaced by the follower's (Write()).
    const auto own = std::ranges::find(kOwn, channel.name);
    if (own != kOwn.end()) {
      columns.push_back(kPass + (own - kOwn.begin()));
      continue;
    }
    const char axis = channel.name[0];
    const bool position = channel.name.substr(1) == "_mm" && axis >= 'x' && axis <= 'z';
    columns.push_back(position ? kX + (axis - 'x') : column++);
  }
  return columns;
}

class SweepRecorder {
 public:
  SweepRecorder(SampleSource& source, const SweepPlan& plan, Clock& clock,
                recording::Writer& writer, const SweepOptions& options)
      : source_(source),
        plan_(plan),
        clock_(clock),
        writer_(writer),
        options_(options),
        visits_(plan.Visits()),
        follower_(plan),
        pace_(clock, options.rate),
        row_(SweepColumns(source.channels()).size()),
        samples_(source.channels(), ColumnsOf(source.channels())) {
    for (std::size_t i = 0; i < 3; ++i) row_[kX + i] = options.rest[i] / kMillimetre;
    swept_ = kX + (plan.axis - 'X');
    const auto columns = ColumnsOf(source.channels());
    has_position_ = std::find(columns.begin(), columns.end(), swept_) != columns.end();
  }

  SweepOutcome Run() {
    start_s_ = clock_.Now();
    pace_.Begin();
    try {
      outcome_.end = options_.prompt ? Prompted() : Followed();
    } catch (...) {
      writer_.Close();
      throw;
    }
    writer_.Close();
    outcome_.seconds = clock_.Now() - start_s_;
    outcome_.fault = source_.Fault();
    outcome_.worst_channel = samples_.WorstChannel();
    outcome_.worst_skew_s = samples_.worst_skew_s();
    return outcome_;
  }

 private:
  // Reads one set into the row; the flags of the set.
  std::uint32_t Read() {
    const bool kept = pace_.Await();
    const SampleSet set = source_.Read();
    pace_.Done();
    set_s_ = set.time_s - start_s_;
    return samples_.Fill(set, row_, !kept);
  }

  void Write(int pass, int direction, std::uint32_t flags) {
    if (!(set_s_ > row_s_)) return;  // the same set again is no new row
    row_[kTime] = row_s_ = set_s_;
    row_[kPass] = pass;
    row_[kDirection] = direction;
    row_[kFeed] = plan_.feed / settings::UnitOf("feed_mm_min").si;
    row_.back() = flags;
    writer_.Append(row_);
    ++outcome_.rows;
    outcome_.flagged += flags != 0 ? 1 : 0;
  }

  // Tells the caller when something has changed.
  void Report(std::size_t done) {
    std::string fault = source_.Fault();
    if (!options_.progress || (done == reported_ && fault == reported_fault_)) return;
    reported_ = done;
    reported_fault_ = fault;
    options_.progress({done, visits_.size(), set_s_, std::move(fault)});
  }

  bool Stopped() const { return options_.stopped && options_.stopped(); }

  SweepEnd Followed() {
    if (!has_position_) {
      throw InputError(
          fmt::format("no device gives {:c}_mm, so the sweep cannot be followed; add the "
                      "channel to the machine file or let the operator confirm each station",
                      plan_.axis - 'X' + 'x'));
    }
    while (true) {
      if (Stopped()) return End(SweepEnd::kStopped);
      if (source_.Ended()) return End(SweepEnd::kSourceEnded);
      const std::uint32_t flags = Read();
      const double position = row_[swept_] * kMillimetre;
      const SweepState& state = follower_.Step(
          std::isnan(position) ? std::optional<double>{} : position, set_s_, flags == 0);
      if (state.pass > plan_.passes) return End(SweepEnd::kComplete);
      if (state.pass > 0) Write(state.pass, state.direction, flags);
      Report(follower_.visits_done());
      if (follower_.complete()) return End(SweepEnd::kComplete);
      if (set_s_ - follower_.last_motion_s() > plan_.idle) return Standstill();
    }
  }

  SweepEnd Standstill() {
    if (follower_.moved()) return End(SweepEnd::kStandstill);
    const std::string fault = source_.Fault();
    throw DeviceError(fmt::format(
        "the {:c} axis did not move for {:.6g} s{}; start the machine's program and try again",
        plan_.axis, plan_.idle, fault.empty() ? std::string() : " (" + fault + ")"));
  }

  SweepEnd End(SweepEnd end) {
    outcome_.lacking = follower_.Lacking();
    return end;
  }

  SweepEnd Prompted() {
    for (std::size_t i = 0; i < visits_.size(); ++i) {
      const bool goes_on = Arrived(visits_[i]) && Dwell(visits_[i]);
      if (!goes_on) {
        outcome_.lacking.insert(outcome_.lacking.end(), visits_.begin() + i, visits_.end());
        return source_.Ended() ? SweepEnd::kSourceEnded : SweepEnd::kStopped;
      }
      Report(i + 1);
    }
    return SweepEnd::kComplete;
  }

  // Asks until the axis stands where it should; false when that is no longer wanted.
  bool Arrived(const Visit& visit) {
    while (!Stopped() && !source_.Ended() && options_.prompt(visit)) {
      if (!has_position_) return true;
      pace_.Begin();
      Read();
      const double station = plan_.stations[visit.station];
      const double position = row_[swept_] * kMillimetre;
      if (std::abs(position - station) <= plan_.window) return true;
      if (!options_.refused) continue;
      const std::string fault = source_.Fault();
      options_.refused(
          std::isnan(position)
              ? fmt::format("the {:c} axis gives no position{}{}; mend it and confirm again",
                            plan_.axis, fault.empty() ? "" : ": ", fault)
              : fmt::format("{:c} stands at {:.4f} mm, not within {:.3g} mm of {:.4f} mm: move it "
                            "there and confirm again, or correct the station or window_um",
                            plan_.axis, position / kMillimetre, plan_.window / kMillimetre,
                            station / kMillimetre));
    }
    return false;
  }

  // Records one visit that the operator has confirmed; false when it was cut short.
  bool Dwell(const Visit& visit) {
    if (!has_position_) pace_.Begin();  // else Arrived() has
    const double settled_s = pace_.next_s() + plan_.settle;
    bool good = false;
    do {
      if (Stopped() || source_.Ended()) return false;
      const std::uint32_t flags = Read();
      if (!has_position_) row_[swept_] = plan_.stations[visit.station] / kMillimetre;
      good = good || (flags == 0 && set_s_ + start_s_ >= settled_s);
      Write(visit.pass, visit.direction, flags);
    } while (pace_.next_s() <= settled_s + plan_.dwell);
    if (!good) outcome_.lacking.push_back(visit);
    return true;
  }

  SampleSource& source_;
  const SweepPlan& plan_;
  Clock& clock_;
  recording::Writer& writer_;
  const SweepOptions& options_;
  const std::vector<Visit> visits_;
  SweepFollower follower_;
  Pace pace_;
  std::vector<double> row_;
  SampleRow samples_;
  std::size_t swept_ = kX;
  bool has_position_ = false;
  double start_s_ = 0.0, set_s_ = 0.0, row_s_ = -1.0;
  std::size_t reported_ = 0;
  std::string reported_fault_;
  SweepOutcome outcome_;
};

}  // namespace

std::string_view NameOf(SweepEnd end) {
  switch (end) {
    case SweepEnd::kComplete:
      return "complete";
    case SweepEnd::kStopped:
      return "stopped";
    case SweepEnd::kSourceEnded:
      return "the recording has ended";
    case SweepEnd::kStandstill:
      return "the machine stands still";
  }
  return "";
}

SweepOutcome RecordSweep(SampleSource& source, const SweepPlan& plan, Clock& clock,
                         recording::Writer& writer, const SweepOptions& options) {
  return SweepRecorder(source, plan, clock, writer, options).Run();
}

}  // namespace abbe::hal
