// Campaigns made by hand, and stores in a folder of their own.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "history/campaign.h"
#include "history/store.h"
#include "recording/file_hash.h"

namespace abbe::history {

// A folder that is there for one test.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "abbe-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder for the test");
    folder_ = pattern;
  }
  ~Scratch() { std::filesystem::remove_all(folder_); }
  std::filesystem::path operator/(std::string_view name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

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

// A result with these figures; `text` stands for its JSON and makes it another one.
inline ResultFile MadeResult(std::vector<Figure> figures, double measured,
                             const std::string& text) {
  ResultFile result{"made.json", recording::Sha256OfText(text), text, "circle", "", measured, {}};
  result.extract.figures = std::move(figures);
  return result;
}

inline Campaign MadeCampaign(const std::string& machine, double measured,
                             std::vector<ResultFile> results) {
  Campaign campaign;
  campaign.machine = machine;
  campaign.measured = measured;
  campaign.results = std::move(results);
  return campaign;
}

}  // namespace abbe::history
