// A writer that hands rows to the kernel and then to the disk from threads of its own, so that a
// slow disk holds up neither a measurement nor the rows that come meanwhile.
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

// Rows wait in memory for at most a quarter of a second, and at most kMostWaiting numbers of them:
// then Append() hands them over itself. From then on they outlive this program, and the power as
// soon as the disk confirms them. One thread appends. A failure of a thread is thrown by the next
// call.
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
  void Fail();  // keeps the exception at hand
  void ThrowFailure();

  const std::string name_;
  const std::unique_ptr<RowFile> file_;
  const std::size_t columns_;

  std::mutex file_mutex_;  // held while rows go to file_, so that they keep their order
  std::vector<double> leaving_;
  bool closed_ = false;

  std::mutex failure_mutex_;
  std::exception_ptr failure_;  // the first
  std::atomic<bool> failed_ = false;

  std::mutex waiting_mutex_;  // taken after file_mutex_, and only to move rows
  std::vector<double> waiting_;

  std::mutex unsynced_mutex_;
  bool unsynced_ = false;  // the kernel has rows that the disk may not have

  std::condition_variable_any wake_;
  std::jthread writes_, syncs_;  // last, so that they end before what they use
};

}  // namespace abbe::recording
