#include "report/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "report/page_template.h"

namespace abbe::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<fs::path> JsonFiles(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    if (entry->path().extension() == ".json" && entry->is_regular_file(gone)) {
      files.push_back(entry->path());
    }
  }
  if (error) {
    throw InputError(
        fmt::format("{}: cannot be read as a folder ({}); give the folder that a sweep "
                    "or a reduction wrote with --out",
                    folder.string(), error.message()));
  }
  std::ranges::sort(files);
  return files;
}

// Why `value` is not a result; empty if it is one.
std::string WhyForeign(const Json& value) {
  if (value.is_discarded()) return "is not JSON, perhaps truncated; write it again or delete it";
  const bool result =
      value.is_object() && value.contains("command") && value["command"].is_string();
  return result ? "" : "has no text \"command\", so it is not a result of abbe; move it elsewhere";
}

// A discarded value when it is not JSON, or is nested deeper than any result:
// writing and drawing it are recursive.
Json ReadJson(const fs::path& file) {
  constexpr int kDeepest = 100;
  bool too_deep = false;
  const auto keep = [&](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > kDeepest;
    return !too_deep;
  };
  std::ifstream stream(file, std::ios::binary);
  Json value = Json::parse(stream, keep, /*allow_exceptions=*/false);
  return too_deep ? Json(Json::value_t::discarded) : value;
}

// Text for a script element. It cannot end the element or open a comment: in JSON "<" occurs in
// strings only, where it is escaped.
std::string ScriptText(const Json& value) {
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char character : text) {
    if (character == '<') {
      safe += "\\u003c";
    } else {
      safe += character;
    }
  }
  return safe;
}

// `connect`: what the policy of the page adds.
std::string Compose(const Json& content, std::string_view connect = "") {
  const std::string_view page = PageTemplate();
  const std::size_t policy = page.find(kConnectMark);
  const std::size_t mark = page.find(kResultsMark, policy);
  std::string composed(page.substr(0, policy));
  composed += connect;
  composed += page.substr(policy + kConnectMark.size(), mark - policy - kConnectMark.size());
  composed += ScriptText(content);
  composed += page.substr(mark + kResultsMark.size());
  return composed;
}

std::string NameOfFolder(const fs::path& folder) {
  const fs::path name = fs::absolute(folder).lexically_normal();
  return (name.has_filename() ? name : name.parent_path()).filename().string();
}

}  // namespace

Report ComposeReport(const fs::path& folder) {
  Report report;
  Json results = Json::array();
  Json left_out = Json::array();
  for (const fs::path& file : JsonFiles(folder)) {
    Json value = ReadJson(file);
    const std::string why = WhyForeign(value);
    if (why.empty()) {
      results.push_back({{"file", file.filename().string()}, {"result", std::move(value)}});
    } else {
      report.notes.push_back(fmt::format("{}: left out: it {}", file.string(), why));
      left_out.push_back(fmt::format("{} {}", file.filename().string(), why));
    }
  }
  if (results.empty()) {
    throw InputError(fmt::format(
        "{}: no result of abbe in this folder ({} other *.json); run `abbe sweep --out {}` or "
        "`abbe "
        "reduce RECORDING --json {}` first",
        folder.string(), report.notes.size(), folder.string(), (folder / "result.json").string()));
  }
  report.results = results.size();
  report.page = Compose({{"folder", NameOfFolder(folder)},
                         {"results", std::move(results)},
                         {"notes", std::move(left_out)}});
  return report;
}

ResultFile ReadResultFile(const fs::path& file) {
  const Json value = ReadJson(file);
  const std::string why = WhyForeign(value);
  if (!why.empty()) return {"", why};
  return {value.dump(-1, ' ', false, Json::error_handler_t::replace), ""};
}

std::string LivePage(const fs::path& folder, const std::string& live) {
  return Compose({{"folder", NameOfFolder(folder)},
                  {"results", Json::array()},
                  {"notes", Json::array()},
                  {"live", Json::parse(live)}},
                 " connect-src 'self';");
}

}  // namespace abbe::report
