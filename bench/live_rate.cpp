// A recording of eight channels at 1 kHz with or without the live page: what the page costs. For
// live_rate.py, which looks at the page.
//
//   live_rate FILE SECONDS page|alone
//
// Prints the address of the page, and in the end one line: rows, flagged rows, seconds, CPU seconds
// of the process, its largest memory in MB, the longest Append in ms, rows published, of them from
// the file.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include "hal/recorder.h"
#include "live/event_log.h"
#include "live/page_server.h"
#include "live/row_feed.h"
#include "random/counter_random.h"
#include "recording/recording_file.h"

namespace {

using namespace abbe;

// Five gaps, a position, two temperatures: computed, with noise.
class EightChannels : public hal::SampleSource {
 public:
  explicit EightChannels(hal::Clock& clock) : clock_(clock) {
    for (const char* name : {"probe_a_um", "probe_b_um", "probe_c_um", "probe_d_um", "probe_e_um",
                             "x_mm", "temp_table_c", "temp_column_c"}) {
      channels_.push_back({name, "fake"});
    }
  }
  const std::vector<hal::Channel>& channels() const override { return channels_; }
  hal::SampleSet Read() override {
    const double now = clock_.Now();
    hal::SampleSet set{.time_s = now, .sequence = ++count_, .skew_s = 0.0, .samples = {}};
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const double value = 100.0 + std::sin(now) + 0.02 * random_.Normal(8 * count_ + i);
      set.samples.push_back(hal::Sample::Good(value, now, count_));
    }
    return set;
  }

 private:
  hal::Clock& clock_;
  std::vector<hal::Channel> channels_;
  random::CounterRandom random_{1, 1};
  std::uint64_t count_ = 0;
};

// Times each Append.
class TimedWriter : public recording::Writer {
 public:
  TimedWriter(std::unique_ptr<recording::Writer> writer, double& longest)
      : writer_(std::move(writer)), longest_(longest) {}
  void Append(std::span<const double> row) override {
    const auto begin = std::chrono::steady_clock::now();
    writer_->Append(row);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    longest_ = std::max(longest_, took.count());
  }
  void Flush() override { writer_->Flush(); }
  void Close() override { writer_->Close(); }

 private:
  std::unique_ptr<recording::Writer> writer_;
  double& longest_;
};

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const std::string file = argv[1];
  const bool page = std::string(argv[3]) == "page";
  hal::SteadyClock clock;
  EightChannels source(clock);
  const auto columns = hal::RecordColumns(source.channels());
  live::EventLog log;
  std::unique_ptr<live::PageServer> server;
  std::unique_ptr<live::RowFeed> feed;
  std::unique_ptr<recording::Writer> writer =
      recording::Writer::Create(file, "kind = \"dwell\"\n", columns);
  if (page) {
    server = std::make_unique<live::PageServer>(log, "bench", live::PageServerOptions{});
    fmt::print("{}\n", server->url());
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::seconds(1));  // for the browsers
    feed = std::make_unique<live::RowFeed>(log, columns, file);
    writer = feed->Watch(std::move(writer));
  }
  double longest = 0.0;
  TimedWriter timed(std::move(writer), longest);
  const hal::RecordOutcome outcome =
      hal::Record(source, clock, timed, {.rate = 1000.0, .seconds = std::atof(argv[2])});
  if (feed) feed->Finish();
  log.Publish("end", "{}");
  if (server) server->Drain(2.0);
  std::this_thread::sleep_for(std::chrono::milliseconds(page ? 500 : 0));
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  fmt::print("{} {} {:.3f} {:.3f} {:.1f} {:.3f} {} {}\n", outcome.rows, outcome.flagged,
             outcome.seconds, Seconds(used.ru_utime) + Seconds(used.ru_stime),
             static_cast<double>(used.ru_maxrss) / 1024.0, 1e3 * longest, feed ? feed->rows() : 0,
             feed ? feed->from_file() : 0);
}
