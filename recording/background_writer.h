// A writer that hands rows to the disk from a thread of its own, so that a slow disk does not hold
// up a measurement and rows reach it though no further row comes.
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

// Rows wait in memory for at most half a second, and at most kMostWaiting numbers of them: then
// Append() writes them itself. One thread appends. A failure of the thread is thrown by the next
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

  void Run(const std::stop_token& stop);
  void WriteWaiting();

  const std::string name_;
  const std::unique_ptr<RowFile> file_;
  const std::size_t columns_;

  std::mutex file_mutex_;  // held while rows go to file_, so that they keep their order
  std::vector<double> leaving_;
  std::exception_ptr failure_;
  std::atomic<bool> failed_ = false;
  bool closed_ = false;

  std::mutex waiting_mutex_;  // taken after file_mutex_, and only to move rows
  std::vector<double> waiting_;

  std::condition_variable_any wake_;
  std::jthread thread_;  // last, so that it ends before what it uses
};

}  // namespace abbe::recording
