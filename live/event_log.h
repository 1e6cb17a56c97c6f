// The events of a measurement under way, in order, for any number of browsers.
//
//   log.Publish("rows", R"({"n":200})");
//   for (const auto& event : log.After(last_seen, 1.0)) last_seen = event->id;
//
// An event with a key replaces the one that had the same key: a browser that comes later gets the
// newest only, one that was away gets what it has not seen. Nothing else is ever left out.
// Threads: all functions may be called from any. Failure: none.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace abbe::live {

struct Event {
  std::uint64_t id = 0;  // counts from 1
  std::string name;      // "rows", "state", "result", ...
  std::string key;       // empty: never replaced
  std::string data;      // one line of JSON
};

class EventLog {
 public:
  void Publish(const std::string& name, std::string data, const std::string& key = "");

  // The events after `id`, waiting up to `seconds` for the first of them; at most `most`.
  std::vector<std::shared_ptr<const Event>> After(std::uint64_t id, double seconds,
                                                  std::size_t most = 1000);
  // No more events will come: After() does not wait any longer.
  void Close();
  bool closed() const { return closed_; }
  std::uint64_t last() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint64_t, std::shared_ptr<const Event>> events_;
  std::map<std::string, std::uint64_t> by_key_;
  std::uint64_t last_ = 0;
  std::atomic<bool> closed_ = false;
};

}  // namespace abbe::live
