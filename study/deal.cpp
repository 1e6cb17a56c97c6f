#include "study/deal.h"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace abbe::study {
namespace {

// The seeds that are left, and the rows that came. Of all threads of number 0.
class Table {
 public:
  Table(const Dealing& dealing, const Keep& keep) : dealing_(dealing), keep_(keep) {}

  std::optional<std::uint64_t> Next() {
    const std::lock_guard lock(mutex_);
    const bool ended = failure_ || (dealing_.ended != nullptr && *dealing_.ended);
    if (ended || at_ == dealing_.seeds.size()) return std::nullopt;
    return dealing_.seeds[at_++];
  }
  void Keep(std::uint64_t seed, const Row& row) {
    const std::lock_guard lock(mutex_);
    if (failure_) return;
    try {
      keep_(seed, row);
    } catch (...) {
      failure_ = std::current_exception();
    }
  }
  void RethrowFailure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  const Dealing& dealing_;
  const study::Keep& keep_;
  std::mutex mutex_;
  std::size_t at_ = 0;
  std::exception_ptr failure_;
};

int ThreadsOf(const Dealing& dealing, const Ranks& ranks) {
  if (dealing.threads > 0) return dealing.threads;
  return ranks.count() > 1 ? 1 : std::max(1U, std::thread::hardware_concurrency());
}

}  // namespace

Row RowOf(const Study& study, std::uint64_t seed) {
  try {
    return study.World(seed);
  } catch (const std::exception& failure) {
    return {{"failed", failure.what()}};
  }
}

void Deal(const Study& study, const Dealing& dealing, Ranks& ranks, const Keep& keep) {
  // The cores have worlds to work on: what a world deals out stays with its own thread.
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  if (ranks.number() > 0) {
    ranks.Ask([&](std::uint64_t seed) { return RowOf(study, seed).dump(); });
    return;
  }
  Table table(dealing, keep);
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < ThreadsOf(dealing, ranks); ++i) {
      workers.emplace_back([&] {
        while (const auto seed = table.Next()) table.Keep(*seed, RowOf(study, *seed));
      });
    }
    ranks.Serve(
        [&] { return table.Next(); },
        [&](std::uint64_t seed, const std::string& row) { table.Keep(seed, Row::parse(row)); });
  }
  table.RethrowFailure();
}

}  // namespace abbe::study
