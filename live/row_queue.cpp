#include "live/row_queue.h"

#include <utility>

namespace abbe::live {

RowQueue::RowQueue(std::size_t columns, std::size_t most) : columns_(columns), most_(most) {}

void RowQueue::Push(std::span<const double> row) {
  const std::uint64_t number = pushed_++;
  if (pending_.values.empty()) pending_.number = number;
  pending_.values.insert(pending_.values.end(), row.begin(), row.end());
  const std::size_t rows = pending_.values.size() / columns_;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock && rows < most_) return;  // with the next row
  if (lock && rows_ + rows <= most_) {
    const bool follows =
        !waiting_.empty() &&
        waiting_.back().number + waiting_.back().values.size() / columns_ == pending_.number;
    if (!follows) waiting_.push_back({pending_.number, {}});
    auto& values = waiting_.back().values;
    values.insert(values.end(), pending_.values.begin(), pending_.values.end());
    rows_ += rows;
  }
  pending_.values.clear();
}

std::vector<RowQueue::Batch> RowQueue::Take() {
  const std::lock_guard lock(mutex_);
  rows_ = 0;
  return std::exchange(waiting_, {});
}

}  // namespace abbe::live
