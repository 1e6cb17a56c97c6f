// Results of a folder as they appear, change, go, and as the folder itself goes.
#include "live/folder_watch.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>

#include "failure/failure.h"

namespace abbe::live::folder_watch_test {
namespace {

namespace fs = std::filesystem;

class FolderWatchTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              fmt::format("abbe_folder_watch_{}_{}", getpid(),
                          testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void Write(const char* name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  // The newest event of this name, waiting for it up to 20 s.
  nlohmann::json Await(const std::string& name) {
    for (int i = 0; i < 2000; ++i) {
      for (const auto& event : log_.After(seen_, 0.01)) {
        seen_ = event->id;
        if (event->name == name) return nlohmann::json::parse(event->data);
      }
    }
    ADD_FAILURE() << "no event " << name;
    return {};
  }

  EventLog log_;
  std::uint64_t seen_ = 0;
  fs::path folder_;
};

TEST_F(FolderWatchTest, ResultsAppearChangeAndGo) {
  Write("a.json", R"({"command":"reduce","n":1})");
  FolderWatch watch(
      log_, folder_, [](const std::string&) {}, 0.01);
  EXPECT_EQ(Await("result")["result"]["n"], 1);
  Write("a.json", R"({"command":"reduce","n":22})");
  EXPECT_EQ(Await("result")["result"]["n"], 22);
  Write("b.json", "{\"cut");
  const auto note = Await("note");
  EXPECT_EQ(note["file"], "b.json");
  EXPECT_NE(note["note"].get<std::string>().find("is not JSON"), std::string::npos);
  fs::remove(folder_ / "a.json");
  EXPECT_EQ(Await("gone")["file"], "a.json");
}

TEST_F(FolderWatchTest, TheFolderVanishesAndComesBack) {
  std::vector<std::string> said;
  std::mutex mutex;
  FolderWatch watch(
      log_, folder_,
      [&](const std::string& line) {
        const std::lock_guard lock(mutex);
        said.push_back(line);
      },
      0.01);
  fs::remove_all(folder_);
  EXPECT_EQ(Await("folder")["there"], false);
  fs::create_directories(folder_);
  EXPECT_EQ(Await("folder")["there"], true);
  Write("a.json", R"({"command":"reduce"})");
  EXPECT_EQ(Await("result")["file"], "a.json");
  const std::lock_guard lock(mutex);
  ASSERT_EQ(said.size(), 2u);
  EXPECT_NE(said[0].find("has vanished"), std::string::npos);
}

TEST_F(FolderWatchTest, WithoutTheFolderItDoesNotStart) {
  EXPECT_THROW(FolderWatch(log_, folder_ / "none", [](const std::string&) {}), InputError);
}

}  // namespace
}  // namespace abbe::live::folder_watch_test
