// Rows become events without one being lost, also where the queue is far too small.
#include "live/row_feed.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace abbe::live::row_feed_test {
namespace {

const std::vector<std::string> kColumns = {"time_s", "x_mm", "probe_a_um", "flags"};

class RowFeedTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("abbe_row_feed_{}_{}", getpid(),
                          testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<recording::Writer> NewFile(const char* name) {
    file_ = folder_ / name;
    return recording::Writer::Create(file_, "kind = \"dwell\"\n", kColumns);
  }
  std::vector<nlohmann::json> Events(const std::string& name) {
    std::vector<nlohmann::json> found;
    for (const auto& event : log_.After(0, 0.0, 1000000)) {
      if (event->name == name) found.push_back(nlohmann::json::parse(event->data));
    }
    return found;
  }
  std::size_t RowsOfEvents() {
    std::size_t rows = 0;
    for (const auto& event : Events("rows")) rows += event["n"].get<std::size_t>();
    return rows;
  }

  EventLog log_;
  std::filesystem::path folder_, file_;
};

TEST_F(RowFeedTest, BucketsHaveMeanLeastAndMost) {
  auto file = NewFile("a.csv");
  RowFeed feed(log_, kColumns, file_);
  const auto writer = feed.Watch(std::move(file));
  // 0, 0.05, ..., 0.15 s: one bucket; a second one begins at 0.2 s.
  for (int i = 0; i < 4; ++i) writer->Append(std::vector<double>{0.05 * i, 1.0, 10.0 + i, 0.0});
  writer->Append(std::vector<double>{0.2, 2.0, std::nan(""), 4.0});
  writer->Close();
  feed.Finish();
  const auto buckets = Events("rows");
  ASSERT_EQ(buckets.size(), 2u);
  EXPECT_EQ(buckets[0]["n"], 4);
  EXPECT_DOUBLE_EQ(buckets[0]["to"], 0.15);
  EXPECT_EQ(buckets[0]["v"][2], (nlohmann::json{11.5, 10.0, 13.0}));
  EXPECT_TRUE(buckets[0]["v"][0].is_null());
  EXPECT_TRUE(buckets[1]["v"][2].is_null());  // no reading
  EXPECT_EQ(buckets[1]["flags"], 4);
}

TEST_F(RowFeedTest, AStretchOfFlagsIsOneEventWithItsColumns) {
  RowFeed feed(log_, kColumns, {});
  const auto writer = feed.Watch(nullptr);
  const double nan = std::nan("");
  for (int i = 0; i < 100; ++i) {
    const bool bad = i >= 20 && i < 30;
    const bool again = i >= 60;  // 1.5 s after: another stretch
    writer->Append(std::vector<double>{0.05 * i, again ? nan : 1.0, bad ? nan : 1.0,
                                       bad     ? 2.0
                                       : again ? 4.0
                                               : 0.0});
  }
  feed.Finish();
  const auto flags = Events("flag");
  ASSERT_EQ(flags.size(), 2u);
  EXPECT_DOUBLE_EQ(flags[0]["from"], 1.0);
  EXPECT_DOUBLE_EQ(flags[0]["to"], 1.45);
  EXPECT_EQ(flags[0]["rows"], 10);
  EXPECT_EQ(flags[0]["flags"], 2);
  EXPECT_EQ(flags[0]["columns"], nlohmann::json{"probe_a_um"});
  EXPECT_EQ(flags[1]["columns"], nlohmann::json{"x_mm"});
}

// 20 000 rows as fast as they go, a queue of 50: most come from the file, and none is lost, be it
// text or HDF5.
TEST_F(RowFeedTest, WhatTheQueueDropsComesFromTheFile) {
  for (const char* name : {"b.csv", "b.h5"}) {
    log_.Publish("mark", "0");
    const std::size_t before = RowsOfEvents();
    auto file = NewFile(name);
    RowFeed feed(log_, kColumns, file_, {.queue_rows = 50, .bucket_s = 0.2, .poll_s = 0.02});
    const auto writer = feed.Watch(std::move(file));
    constexpr std::size_t kRows = 20000;
    for (std::size_t i = 0; i < kRows; ++i) {
      const double at = 1e-3 * static_cast<double>(i);
      writer->Append(std::vector<double>{at, at, 1.0, 0.0});
    }
    writer->Close();
    feed.Finish();
    EXPECT_EQ(RowsOfEvents() - before, kRows) << name;
    EXPECT_GT(feed.from_file(), kRows / 2) << name;
    EXPECT_TRUE(Events("lost").empty());
    // In order, without a gap: x is the time.
    double last = -1.0;
    for (const auto& event : log_.After(log_.last() - Events("rows").size() / 2, 0.0, 1000000)) {
      if (event->name != "rows") continue;
      const auto bucket = nlohmann::json::parse(event->data);
      EXPECT_GT(bucket["from"].get<double>(), last);
      last = bucket["to"];
    }
    EXPECT_NEAR(last, 1e-3 * (kRows - 1), 1e-9);
  }
}

// A reader that takes nothing for a second does not hold up a row for more than a disk would.
TEST_F(RowFeedTest, WithoutAFileTheLossIsSaid) {
  RowFeed feed(log_, kColumns, {}, {.queue_rows = 10, .bucket_s = 0.2, .poll_s = 0.2});
  const auto writer = feed.Watch(nullptr);
  for (int i = 0; i < 1000; ++i) writer->Append(std::vector<double>{1e-3 * i, 0.0, 0.0, 0.0});
  feed.Finish();
  std::size_t lost = 0;
  for (const auto& event : Events("lost")) lost += event["rows"].get<std::size_t>();
  EXPECT_GT(lost, 0u);
  EXPECT_EQ(RowsOfEvents() + lost, 1000u);
}

}  // namespace
}  // namespace abbe::live::row_feed_test
