// Rows on their way from a recorder to the page: bounded, and never a reason to wait.
//
// The recorder's thread pushes, one thread takes. A row that finds no room is dropped and counted
// by its number; the file has it, and Take() shows which are missing.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

namespace abbe::live {

class RowQueue {
 public:
  // `most`: rows that wait at the same time.
  RowQueue(std::size_t columns, std::size_t most);

  void Push(std::span<const double> row);

  // The rows that wait, in order; `number` is that of the first, counted from 0. Rows of one batch
  // follow each other without a gap.
  struct Batch {
    std::uint64_t number = 0;
    std::vector<double> values;  // rows x columns
  };
  std::vector<Batch> Take();
  // Rows pushed so far, with those that were dropped.
  std::uint64_t pushed() const { return pushed_; }

 private:
  const std::size_t columns_, most_;
  std::mutex mutex_;
  std::vector<Batch> waiting_;
  std::size_t rows_ = 0;
  Batch pending_;  // of the pushing thread: rows that met the lock
  std::atomic<std::uint64_t> pushed_ = 0;
};

}  // namespace abbe::live
