#include "recording/background_writer.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace abbe::recording {
namespace {

constexpr std::chrono::milliseconds kPeriod{250};

}  // namespace

BackgroundWriter::BackgroundWriter(std::string name, std::unique_ptr<RowFile> file,
                                   std::size_t columns)
    : name_(std::move(name)),
      file_(std::move(file)),
      columns_(columns),
      writes_([this](const std::stop_token& stop) { RunWrites(stop); }),
      syncs_([this](const std::stop_token& stop) { RunSyncs(stop); }) {}

BackgroundWriter::~BackgroundWriter() {
  try {
    Close();
  } catch (const std::exception&) {
    // A caller that needs the error calls Close().
  }
}

void BackgroundWriter::Append(std::span<const double> row) {
  if (row.size() != columns_) {
    throw InputError(fmt::format("{}: a row of {} values was appended, but there are {} columns",
                                 name_, row.size(), columns_));
  }
  if (!writes_.joinable()) throw std::logic_error("a row was appended after Close()");
  bool many = false;
  {
    const std::lock_guard lock(waiting_mutex_);
    for (const double value : row) {
      waiting_.push_back(std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value);
    }
    many = waiting_.size() >= kMostWaiting;
  }
  if (many) WriteWaiting();
  if (failed_) ThrowFailure();
}

void BackgroundWriter::Flush() {
  WriteWaiting();
  Sync();
  ThrowFailure();
}

void BackgroundWriter::Close() {
  for (std::jthread* thread : {&writes_, &syncs_}) {
    thread->request_stop();
    if (thread->joinable()) thread->join();
  }
  if (closed_) return;
  WriteWaiting();
  Sync();
  closed_ = true;
  file_->Close();
  ThrowFailure();
}

void BackgroundWriter::WriteWaiting() {
  const std::lock_guard lock(file_mutex_);
  leaving_.clear();
  {
    const std::lock_guard waiting_lock(waiting_mutex_);
    leaving_.swap(waiting_);
  }
  if (leaving_.empty() || failed_ || closed_) return;
  try {
    file_->Write(leaving_);
  } catch (const std::exception&) {
    Fail();
    return;
  }
  {
    const std::lock_guard unsynced_lock(unsynced_mutex_);
    unsynced_ = true;
  }
  wake_.notify_all();
}

void BackgroundWriter::Sync() {
  if (failed_ || closed_) return;
  try {
    file_->Sync();
  } catch (const std::exception&) {
    Fail();
  }
}

void BackgroundWriter::Fail() {
  const std::lock_guard lock(failure_mutex_);
  if (!failure_) failure_ = std::current_exception();
  failed_ = true;
}

void BackgroundWriter::ThrowFailure() {
  const std::lock_guard lock(failure_mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

void BackgroundWriter::RunWrites(const std::stop_token& stop) {
  std::mutex idle;
  std::condition_variable_any never_notified;
  std::unique_lock lock(idle);
  while (!stop.stop_requested()) {
    never_notified.wait_for(lock, stop, kPeriod, [] { return false; });
    WriteWaiting();
  }
}

void BackgroundWriter::RunSyncs(const std::stop_token& stop) {
  std::unique_lock lock(unsynced_mutex_);
  while (wake_.wait(lock, stop, [this] { return unsynced_; })) {
    unsynced_ = false;
    lock.unlock();
    Sync();
    lock.lock();
  }
}

}  // namespace abbe::recording
