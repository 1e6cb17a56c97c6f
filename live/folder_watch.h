// The results in a folder as events for the page, as they appear, change and go.
//
// Events: "result" {file, result} for each *.json that is a result, "gone" {file}, "note" {file,
// note} for another *.json, "folder" {there} when the folder itself vanishes or comes back.
// Failure: InputError when the folder is not there at the start; later that is an event and a line
// to `say`.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <thread>

#include "live/event_log.h"

namespace abbe::live {

class FolderWatch {
 public:
  FolderWatch(EventLog& log, std::filesystem::path folder,
              std::function<void(const std::string& line)> say, double poll_s = 0.5);
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  // Looks once more and ends.
  void Finish();

 private:
  struct Stamp {
    std::filesystem::file_time_type changed;
    std::uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };
  void Look();

  EventLog& log_;
  const std::filesystem::path folder_;
  const std::function<void(const std::string&)> say_;
  std::map<std::string, Stamp> known_;
  bool there_ = true;
  std::jthread thread_;
};

}  // namespace abbe::live
