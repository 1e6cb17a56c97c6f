// A writer with background threads: rows go to the kernel and then to the disk without blocking the
// measurement, also on a slow disk.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "recording/recording_file.h"
#include "recording/row_file.h"

namespace abbe::recording {

// Rows wait in memory for at most a quarter of a second; from kMostWaiting numbers on Append()
// itself passes them to the kernel. From then on they survive a crash of this program, and a power
// failure once the disk has confirmed them.
// Threads: one thread appends. A failure of a background thread is thrown by the next call.
class BackgroundWriter : public Writer {
 public:
  BackgroundWriter(std::string name, std::unique_ptr<RowFile> file, std::size_t columns);
  ~BackgroundWriter() override;

  void Append(std::span<const double> row) override;
  void Flush() override;
  void Close() override;

 private:
  static constexpr std::size_t kMostWaiting = std::size_t{1} << 17;

  void RunWrites(const std::stop_token& stop);
  void RunSyncs(const std::stop_token& stop);
  void WriteWaiting();
  void Sync();
  void Fail();  // stores the current exception
  void ThrowFailure();

  const std::string name_;
  const std::unique_ptr<RowFile> file_;
  const std::size_t columns_;

  std::mutex file_mutex_;  // held while rows go to file_, to keep their order
  std::vector<double> leaving_;
  bool closed_ = false;

  std::mutex failure_mutex_;
  std::exception_ptr failure_;  // the first one
  std::atomic<bool> failed_ = false;

  std::mutex waiting_mutex_;  // locked after file_mutex_, only to move rows
  std::vector<double> waiting_;

  std::mutex unsynced_mutex_;
  bool unsynced_ = false;  // the kernel has rows that may not be on the disk

  std::condition_variable_any wake_;
  std::jthread writes_, syncs_;  // last: they end before the members they use are destroyed
};

}  // namespace abbe::recording
