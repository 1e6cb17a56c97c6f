#include "report/report_page.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../folders.h"
#include "report/page_template.h"

namespace abbe::report {
namespace report_page_test {

namespace fs = std::filesystem;

constexpr std::string_view kElement = "<script type=\"application/json\" id=\"results\">";

class ReportPage : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = BuildFolder() / "tests/report/unit" / test->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    page_ = folder_ / "report.html";
  }

  void Put(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }

  std::string Page() const {
    std::ostringstream text;
    text << std::ifstream(page_, std::ios::binary).rdbuf();
    return text.str();
  }

  // What the browser will parse: the text from the element's tag to the first end tag.
  nlohmann::json Embedded() const {
    const std::string page = Page();
    const std::size_t begin = page.find(kElement) + kElement.size();
    return nlohmann::json::parse(page.substr(begin, page.find("</script", begin) - begin));
  }

  Report Write() const {
    const Report report = ComposeReport(folder_);
    std::ofstream(page_, std::ios::binary) << report.page;
    return report;
  }

  std::string WhatIsThrown() const {
    try {
      ComposeReport(folder_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
  fs::path page_;
};

TEST_F(ReportPage, TemplateHasOnePlaceForResults) {
  const std::string_view page = PageTemplate();
  const std::size_t mark = page.find(kResultsMark);
  ASSERT_NE(mark, std::string_view::npos);
  EXPECT_EQ(page.find(kResultsMark, mark + 1), std::string_view::npos);
  EXPECT_EQ(page.substr(mark - kElement.size(), kElement.size()), kElement);
  EXPECT_TRUE(page.ends_with("</html>\n"));
}

TEST_F(ReportPage, HoldsResultsInTheOrderOfTheirFiles) {
  Put("b.json", R"({"command": "reduce", "kind": "sweep", "value": 0.1})");
  Put("a.json", R"({"command": "reduce", "kind": "reference", "list": [1e-300, null]})");
  Put("recording.csv", "time_s\n");
  const Report written = Write();
  EXPECT_EQ(written.results, 2u);
  EXPECT_TRUE(written.notes.empty());
  const nlohmann::json embedded = Embedded();
  EXPECT_EQ(embedded["folder"], "HoldsResultsInTheOrderOfTheirFiles");
  EXPECT_EQ(embedded["results"][0]["file"], "a.json");
  EXPECT_EQ(embedded["results"][0]["result"]["list"][0], 1e-300);
  EXPECT_EQ(embedded["results"][1]["result"]["value"], 0.1);
}

TEST_F(ReportPage, TextCannotLeaveTheElement) {
  const std::string hostile = "</script><script>alert(1)</script><!-- \" \\ @@results@@";
  Put("a.json", nlohmann::json{{"command", "reduce"}, {"remark", hostile}}.dump());
  Write();
  EXPECT_EQ(Embedded()["results"][0]["result"]["remark"], hostile);
}

TEST_F(ReportPage, LeavesOutWhatIsNoResultAndSaysSo) {
  Put("a.json", R"({"command": "reduce"})");
  Put("cut.json", R"({"command": "red)");
  Put("empty.json", "");
  Put("foreign.json", R"({"name": "other"})");
  Put("list.json", "[1, 2]");
  Put("odd.json", R"({"command": 7})");
  const Report written = Write();
  EXPECT_EQ(written.results, 1u);
  ASSERT_EQ(written.notes.size(), 5u);
  EXPECT_NE(written.notes[0].find((folder_ / "cut.json").string() + ": left out: it is not JSON"),
            std::string::npos);
  EXPECT_NE(written.notes[2].find("foreign.json: left out: it has no text \"command\""),
            std::string::npos);
  EXPECT_EQ(Embedded()["notes"].size(), 5u);
}

TEST_F(ReportPage, EmptyFolderSaysWhatToDo) {
  const std::string message = WhatIsThrown();
  EXPECT_NE(message.find(folder_.string() + ": no result of abbe"), std::string::npos) << message;
  EXPECT_NE(message.find("abbe sweep"), std::string::npos) << message;
  EXPECT_FALSE(fs::exists(page_));
}

TEST_F(ReportPage, MissingFolderIsNamed) {
  folder_ /= "missing";
  EXPECT_NE(WhatIsThrown().find("missing: cannot be read as a folder"), std::string::npos);
}

TEST_F(ReportPage, LeavesOutWhatIsNestedWithoutEnd) {
  Put("a.json", R"({"command": "reduce"})");
  constexpr int kDepth = 200'000;
  Put("deep.json",
      R"({"command": "reduce", "x": )" + std::string(kDepth, '[') + std::string(kDepth, ']') + "}");
  const Report report = Write();
  EXPECT_EQ(report.results, 1u);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_NE(report.notes[0].find("deep.json: left out"), std::string::npos) << report.notes[0];
}

TEST_F(ReportPage, ComposedTwiceIsTheSamePage) {
  Put("a.json", R"({"command": "reduce"})");
  Write();
  const std::string first = Page();
  Write();
  EXPECT_EQ(Page(), first);
}

}  // namespace report_page_test
}  // namespace abbe::report
