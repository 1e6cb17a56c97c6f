#include "live/folder_watch.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>

#include "failure/failure.h"
#include "report/report_page.h"

namespace abbe::live {
namespace {

namespace fs = std::filesystem;

std::string JsonText(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

FolderWatch::FolderWatch(EventLog& log, fs::path folder,
                         std::function<void(const std::string& line)> say, double poll_s)
    : log_(log), folder_(std::move(folder)), say_(std::move(say)) {
  if (!fs::is_directory(folder_)) {
    throw InputError(fmt::format("{}: is no folder; give the folder into which abbe writes results",
                                 folder_.string()));
  }
  Look();
  thread_ = std::jthread([this, poll_s](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, stop, std::chrono::duration<double>(poll_s), [] {
      return false;
    }) && !stop.stop_requested()) {
      Look();
    }
  });
}

FolderWatch::~FolderWatch() { Finish(); }

void FolderWatch::Finish() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  Look();
}

void FolderWatch::Look() {
  std::error_code error;
  std::map<std::string, Stamp> found;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() != ".json") continue;
    std::error_code gone;
    const Stamp stamp{entry->last_write_time(gone), entry->file_size(gone)};
    if (!gone) found[entry->path().filename().string()] = stamp;
  }
  if (there_ != !error) {
    there_ = !error;
    log_.Publish("folder", there_ ? R"({"there":true})" : R"({"there":false})", "folder");
    say_(there_
             ? fmt::format("{}: is there again", folder_.string())
             : fmt::format("{}: has vanished ({}); the page keeps what it shows and waits for it",
                           folder_.string(), error.message()));
  }
  if (error) return;
  for (const auto& [name, stamp] : found) {
    const auto known = known_.find(name);
    if (known != known_.end() && known->second == stamp) continue;
    const report::ResultFile file = report::ReadResultFile(folder_ / name);
    const std::string key = "file " + name;
    if (file.note.empty()) {
      log_.Publish("result",
                   fmt::format("{{\"file\":{},\"result\":{}}}", JsonText(name), file.json), key);
    } else {
      log_.Publish("note",
                   fmt::format("{{\"file\":{},\"note\":{}}}", JsonText(name), JsonText(file.note)),
                   key);
    }
  }
  for (const auto& [name, stamp] : known_) {
    if (found.contains(name)) continue;
    log_.Publish("gone", fmt::format("{{\"file\":{}}}", JsonText(name)), "file " + name);
  }
  known_ = std::move(found);
}

}  // namespace abbe::live
