// Dealing out: every piece once, also from within a piece; the failure is that of the first in order,
// however many threads there are and whichever comes first in time.
#include "estimation/in_parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace abbe::estimation::in_parallel_test {
namespace {

TEST(InParallel, DoesEachPieceOnce) {
  std::vector<int> done(1000, 0);
  InParallel(done.size(), [&](std::size_t i) { ++done[i]; });
  EXPECT_EQ(done, std::vector<int>(1000, 1));
  InParallel(0, [](std::size_t) { FAIL(); });
}

TEST(InParallel, DealsOutWithinAPiece) {
  std::vector<std::vector<int>> done(20, std::vector<int>(30, 0));
  InParallel(done.size(), [&](std::size_t i) {
    InParallel(done[i].size(), [&](std::size_t k) { ++done[i][k]; });
  });
  for (const auto& each : done) EXPECT_EQ(std::accumulate(each.begin(), each.end(), 0), 30);
}

TEST(InParallel, ThrowsWhatTheFirstInOrderThrows) {
  std::atomic<int> done = 0;
  try {
    InParallel(8, [&](std::size_t i) {
      ++done;
      if (i == 3) std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the last in time
      if (i >= 3) throw std::runtime_error(std::to_string(i));
    });
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& failure) {
    EXPECT_STREQ(failure.what(), "3");
  }
  EXPECT_EQ(done, 8);
}

}  // namespace
}  // namespace abbe::estimation::in_parallel_test
