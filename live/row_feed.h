// The rows of a recording under way as events for the page: for each fifth of a second the mean,
// the smallest and the largest value of each column, and the stretches of rows with a flag.
//
//   RowFeed feed(log, columns, "out/sweep_X.csv");
//   const auto writer = feed.Watch(recording::Writer::Create(path, header, columns));
//
// The recorder appends to the watched writer as to any other: a row goes to the file first, then
// into a bounded queue (row_queue.h). A thread of the feed takes them from there, and from the file
// those that found no room in the queue, so that the page misses none.
//
// Events: "columns" {names}; "rows" {from, to, n, flags, v: [[mean, least, most], ...]} in the
// units of the columns (null where no row has a number); "flag" {from, to, rows, flags, columns},
// replaced while the stretch goes on.
// Units: s of the recording. Failure: none reaches the recorder but those of the file.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "live/event_log.h"
#include "live/row_queue.h"
#include "recording/recording_file.h"

namespace abbe::live {

struct RowFeedOptions {
  std::size_t queue_rows = 20000;  // 20 s at 1000 Hz
  double bucket_s = 0.2;
  double poll_s = 0.05;
};

class RowFeed {
 public:
  // `file`: the recording, to catch up from; empty: there is none, and what is dropped is lost.
  RowFeed(EventLog& log, std::vector<std::string> columns, std::filesystem::path file,
          const RowFeedOptions& options = {});
  ~RowFeed();
  RowFeed(const RowFeed&) = delete;
  RowFeed& operator=(const RowFeed&) = delete;

  std::unique_ptr<recording::Writer> Watch(std::unique_ptr<recording::Writer> writer);
  // A row that goes to no file.
  void Push(std::span<const double> row) { queue_.Push(row); }
  // Publishes what is left; the rest of the calls are ignored.
  void Finish();

  std::uint64_t rows() const { return next_; }            // published or in the open bucket
  std::uint64_t from_file() const { return from_file_; }  // of them

 private:
  struct Sums {
    double sum = 0.0, least = 0.0, most = 0.0;
    std::size_t count = 0;
  };
  struct Flagged {
    double from = 0.0, to = 0.0;
    std::uint64_t rows = 0, number = 0;
    std::uint32_t flags = 0;
    std::vector<bool> columns = {};  // without a number
  };

  void Run(const std::stop_token& stop);
  void TakeWaiting();
  void CatchUp(std::uint64_t until);
  void Add(std::span<const double> row);
  void PublishBucket();
  void NoteFlags(std::span<const double> row);
  void PublishFlags();

  EventLog& log_;
  const std::vector<std::string> columns_;
  const std::filesystem::path file_;
  const RowFeedOptions options_;
  std::size_t time_ = 0;
  std::optional<std::size_t> flags_;
  RowQueue queue_;
  std::atomic<std::uint64_t> next_ = 0, from_file_ = 0;
  std::vector<Sums> sums_;
  double from_ = 0.0, to_ = 0.0;
  std::uint64_t bucket_rows_ = 0;
  std::uint32_t bucket_flags_ = 0;
  std::optional<Flagged> flagged_;
  std::uint64_t flagged_count_ = 0;
  bool flagged_changed_ = false;
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace abbe::live
