#include "recording/background_writer.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace abbe::recording {
namespace {

constexpr std::chrono::milliseconds kPeriod{500};

}  // namespace

BackgroundWriter::BackgroundWriter(std::string name, std::unique_ptr<RowFile> file,
                                   std::size_t columns)
    : name_(std::move(name)),
      file_(std::move(file)),
      columns_(columns),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

BackgroundWriter::~BackgroundWriter() {
  try {
    Close();
  } catch (const std::exception&) {
    // Close() is there for whoever wants to know.
  }
}

void BackgroundWriter::Append(std::span<const double> row) {
  if (row.size() != columns_) {
    throw InputError(fmt::format("{}: a row of {} values was appended, but there are {} columns",
                                 name_, row.size(), columns_));
  }
  if (!thread_.joinable()) throw std::logic_error("a row was appended after Close()");
  bool many = false;
  {
    const std::lock_guard lock(waiting_mutex_);
    for (const double value : row) {
      waiting_.push_back(std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value);
    }
    many = waiting_.size() >= kMostWaiting;
  }
  if (many || failed_) Flush();
}

void BackgroundWriter::Flush() {
  const std::lock_guard lock(file_mutex_);
  WriteWaiting();
  if (failure_) std::rethrow_exception(failure_);
}

void BackgroundWriter::Close() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(file_mutex_);
  if (closed_) return;
  WriteWaiting();
  closed_ = true;
  file_->Close();
  if (failure_) std::rethrow_exception(failure_);
}

// With file_mutex_ held.
void BackgroundWriter::WriteWaiting() {
  leaving_.clear();
  {
    const std::lock_guard lock(waiting_mutex_);
    leaving_.swap(waiting_);
  }
  if (leaving_.empty() || failure_ || closed_) return;
  try {
    file_->Write(leaving_);
  } catch (const std::exception&) {
    failure_ = std::current_exception();
    failed_ = true;
  }
}

void BackgroundWriter::Run(const std::stop_token& stop) {
  std::mutex idle;
  std::unique_lock lock(idle);
  while (!stop.stop_requested()) {
    wake_.wait_for(lock, stop, kPeriod, [] { return false; });
    const std::lock_guard file_lock(file_mutex_);
    WriteWaiting();
  }
}

}  // namespace abbe::recording
