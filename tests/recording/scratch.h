// What the tests of recording/ share: a folder of their own, files of text, and a small recording.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "recording/blocks.h"

namespace abbe::recording {

// A folder that is there for one test.
class Scratch {
 public:
  explicit Scratch(const std::filesystem::path& parent = std::filesystem::temp_directory_path()) {
    std::string pattern = (parent / "abbe-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder for the test");
    folder_ = pattern;
  }
  ~Scratch() { std::filesystem::remove_all(folder_); }
  std::filesystem::path operator/(std::string_view name) const { return folder_ / name; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

inline void Put(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string Bytes(const std::filesystem::path& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

// The message of the failure of type F that `action` ends in; it has one line.
template <typename F, typename Action>
std::string MessageOf(const Action& action) {
  try {
    action();
  } catch (const F& failure) {
    EXPECT_EQ(std::string_view(failure.what()).find('\n'), std::string_view::npos)
        << failure.what();
    return failure.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

inline void ExpectHas(std::string_view text, std::string_view part) {
  EXPECT_NE(text.find(part), std::string_view::npos) << "`" << text << "` lacks `" << part << "`";
}

// The blocks of a recording put together again.
inline Recording Joined(const Blocks& blocks) {
  Recording whole;
  blocks([&](const Recording& block) {
    EXPECT_EQ(block.first_row, whole.rows());
    EXPECT_TRUE(whole.warnings.empty()) << "before the last block";
    const std::vector<Column> before = std::move(whole.columns);
    whole = block;
    for (std::size_t c = 0; c < before.size(); ++c) {
      auto& values = whole.columns[c].values;
      values.insert(values.begin(), before[c].values.begin(), before[c].values.end());
    }
  });
  return whole;
}

// A dwell with a time and a temperature.
inline Recording Dwell(std::size_t rows) {
  Recording recording;
  recording.header = "kind = \"dwell\"\n";
  recording.columns = {{"time_s", {}}, {"temp_column_c", {}}, {"flags", {}}};
  for (std::size_t i = 0; i < rows; ++i) {
    recording.columns[0].values.push_back(0.005 * static_cast<double>(i));
    recording.columns[1].values.push_back(20.0 + 0.001 * static_cast<double>(i % 977));
    recording.columns[2].values.push_back(0.0);
  }
  return recording;
}

}  // namespace abbe::recording
