#include "live/row_feed.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "failure/failure.h"

namespace abbe::live {
namespace {

constexpr double kFlagsApart = 1.0;  // s: nearer stretches are one
// The writer hands rows over within 1/4 s; on a processor that others use, later.
constexpr std::chrono::seconds kFilePatience{10};

class WatchedWriter : public recording::Writer {
 public:
  WatchedWriter(std::unique_ptr<recording::Writer> file, RowFeed& feed)
      : file_(std::move(file)), feed_(feed) {}

  void Append(std::span<const double> row) override {
    if (file_) file_->Append(row);
    feed_.Push(row);
  }
  void Flush() override {
    if (file_) file_->Flush();
  }
  void Close() override {
    if (file_) file_->Close();
  }

 private:
  std::unique_ptr<recording::Writer> file_;
  RowFeed& feed_;
};

void AppendNumber(std::string& text, double value) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(text), "{:.7g}", value);
  } else {
    text += "null";
  }
}

}  // namespace

RowFeed::RowFeed(EventLog& log, std::vector<std::string> columns, std::filesystem::path file,
                 const RowFeedOptions& options)
    : log_(log),
      columns_(std::move(columns)),
      file_(std::move(file)),
      options_(options),
      queue_(columns_.size(), options.queue_rows),
      sums_(columns_.size()) {
  const auto time = std::ranges::find(columns_, "time_s");
  if (time == columns_.end()) throw InputError("a live recording needs the column time_s");
  time_ = static_cast<std::size_t>(time - columns_.begin());
  const auto flags = std::ranges::find(columns_, "flags");
  if (flags != columns_.end()) flags_ = static_cast<std::size_t>(flags - columns_.begin());
  log_.Publish("columns", nlohmann::json(columns_).dump(), "columns");
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

RowFeed::~RowFeed() { Finish(); }

std::unique_ptr<recording::Writer> RowFeed::Watch(std::unique_ptr<recording::Writer> writer) {
  return std::make_unique<WatchedWriter>(std::move(writer), *this);
}

void RowFeed::Finish() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void RowFeed::Run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::duration<double>(options_.poll_s));
    TakeWaiting();
  }
  TakeWaiting();
  CatchUp(queue_.pushed());
  PublishBucket();
  PublishFlags();
}

void RowFeed::TakeWaiting() {
  for (const RowQueue::Batch& batch : queue_.Take()) {
    CatchUp(batch.number);
    const std::size_t rows = batch.values.size() / columns_.size();
    for (std::size_t row = 0; row < rows; ++row) {
      if (batch.number + row < next_) continue;
      Add(std::span(batch.values).subspan(row * columns_.size(), columns_.size()));
    }
  }
  PublishFlags();
}

// Adds the rows before number `until` that the queue dropped.
void RowFeed::CatchUp(std::uint64_t until) {
  using Clock = std::chrono::steady_clock;
  const auto given_up = Clock::now() + kFilePatience;
  while (next_ < until && !file_.empty() && Clock::now() < given_up) {
    try {
      recording::ReadBlocks(file_, [&](const recording::Recording& block) {
        std::vector<double> values(columns_.size());
        for (std::size_t row = 0; row < block.rows(); ++row) {
          const std::uint64_t number = block.first_row + row;
          if (number != next_ || number >= until) continue;
          for (std::size_t i = 0; i < columns_.size(); ++i)
            values[i] = block.columns[i].values[row];
          Add(values);
          ++from_file_;
        }
      });
    } catch (const Failure&) {
      // The last row is not whole yet.
    }
    if (next_ < until) {
      std::this_thread::sleep_for(std::chrono::duration<double>(options_.poll_s));
    }
  }
  if (next_ >= until) return;
  log_.Publish("lost", fmt::format("{{\"rows\":{}}}", until - next_));
  next_ = until;
}

void RowFeed::Add(std::span<const double> row) {
  ++next_;
  const double time = row[time_];
  if (bucket_rows_ > 0 && time >= from_ + options_.bucket_s) PublishBucket();
  if (bucket_rows_ == 0) from_ = time;
  to_ = time;
  ++bucket_rows_;
  if (flags_) bucket_flags_ |= static_cast<std::uint32_t>(row[*flags_]);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (std::isnan(row[i])) continue;
    Sums& sums = sums_[i];
    sums.least = sums.count == 0 ? row[i] : std::min(sums.least, row[i]);
    sums.most = sums.count == 0 ? row[i] : std::max(sums.most, row[i]);
    sums.sum += row[i];
    ++sums.count;
  }
  NoteFlags(row);
}

void RowFeed::PublishBucket() {
  if (bucket_rows_ == 0) return;
  std::string text = fmt::format("{{\"from\":{:.6f},\"to\":{:.6f},\"n\":{},\"flags\":{},\"v\":[",
                                 from_, to_, bucket_rows_, bucket_flags_);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& sums = sums_[i];
    if (i > 0) text += ',';
    if (i == time_ || i == flags_ || sums.count == 0) {
      text += "null";
      continue;
    }
    text += '[';
    AppendNumber(text, sums.sum / static_cast<double>(sums.count));
    text += ',';
    AppendNumber(text, sums.least);
    text += ',';
    AppendNumber(text, sums.most);
    text += ']';
  }
  log_.Publish("rows", text + "]}");
  std::ranges::fill(sums_, Sums{});
  bucket_rows_ = 0;
  bucket_flags_ = 0;
}

void RowFeed::NoteFlags(std::span<const double> row) {
  const auto flags = flags_ ? static_cast<std::uint32_t>(row[*flags_]) : 0U;
  if (flags == 0) return;
  const double time = row[time_];
  if (flagged_ && time > flagged_->to + kFlagsApart) {
    PublishFlags();
    flagged_.reset();
  }
  if (!flagged_) {
    flagged_ = Flagged{.from = time, .number = ++flagged_count_};
    flagged_->columns.resize(columns_.size(), false);
  }
  flagged_->to = time;
  flagged_->flags |= flags;
  ++flagged_->rows;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (std::isnan(row[i])) flagged_->columns[i] = true;
  }
  flagged_changed_ = true;
}

void RowFeed::PublishFlags() {
  if (!flagged_ || !flagged_changed_) return;
  nlohmann::ordered_json json = {
      {"number", flagged_->number}, {"from", flagged_->from},
      {"to", flagged_->to},         {"rows", flagged_->rows},
      {"flags", flagged_->flags},   {"columns", nlohmann::json::array()}};
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (flagged_->columns[i]) json["columns"].push_back(columns_[i]);
  }
  log_.Publish("flag", json.dump(), fmt::format("flag {}", flagged_->number));
  flagged_changed_ = false;
}

}  // namespace abbe::live
