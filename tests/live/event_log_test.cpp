// What a browser gets: all in order, the newest of a key, what it missed.
#include "live/event_log.h"

#include <gtest/gtest.h>

#include <thread>

namespace abbe::live::event_log_test {
namespace {

std::string DataOf(const std::vector<std::shared_ptr<const Event>>& events) {
  std::string data;
  for (const auto& event : events) data += event->data;
  return data;
}

TEST(EventLog, ABrowserThatWasAwayGetsWhatItMissed) {
  EventLog log;
  for (const char* data : {"1", "2", "3"}) log.Publish("rows", data);
  EXPECT_EQ(DataOf(log.After(0, 0.0)), "123");
  EXPECT_EQ(DataOf(log.After(2, 0.0)), "3");
  EXPECT_EQ(DataOf(log.After(3, 0.0)), "");
  EXPECT_EQ(DataOf(log.After(0, 0.0, 2)), "12");
}

TEST(EventLog, AnEventReplacesThatOfItsKey) {
  EventLog log;
  log.Publish("state", "a", "state");
  log.Publish("rows", "b");
  log.Publish("state", "c", "state");
  EXPECT_EQ(DataOf(log.After(0, 0.0)), "bc");
  EXPECT_EQ(DataOf(log.After(1, 0.0)), "bc");  // one that saw the old state gets the new one
  EXPECT_EQ(log.last(), 3u);
}

TEST(EventLog, ThreadsThatPublishAndReadLoseNothing) {
  EventLog log;
  constexpr std::size_t kEach = 5000;
  std::vector<std::jthread> writers;
  for (int i = 0; i < 3; ++i) {
    writers.emplace_back([&] {
      for (std::size_t k = 0; k < kEach; ++k) log.Publish("rows", "x");
    });
  }
  std::vector<std::size_t> seen(2, 0);
  std::vector<std::jthread> readers;
  for (std::size_t& count : seen) {
    readers.emplace_back([&] {
      std::uint64_t last = 0;
      while (count < 3 * kEach) {
        for (const auto& event : log.After(last, 5.0)) {
          ASSERT_EQ(event->id, last + 1);
          last = event->id;
          ++count;
        }
      }
    });
  }
  readers.clear();
  EXPECT_EQ(seen, (std::vector<std::size_t>{3 * kEach, 3 * kEach}));
}

TEST(EventLog, ClosedItDoesNotWait) {
  EventLog log;
  std::jthread closer([&] { log.Close(); });
  EXPECT_TRUE(log.After(0, 60.0).empty());
  EXPECT_TRUE(log.closed());
}

}  // namespace
}  // namespace abbe::live::event_log_test
