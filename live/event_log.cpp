#include "live/event_log.h"

#include <chrono>

namespace abbe::live {

void EventLog::Publish(const std::string& name, std::string data, const std::string& key) {
  const std::lock_guard lock(mutex_);
  if (!key.empty()) {
    const auto older = by_key_.find(key);
    if (older != by_key_.end()) events_.erase(older->second);
    by_key_[key] = last_ + 1;
  }
  ++last_;
  events_[last_] = std::make_shared<const Event>(Event{last_, name, key, std::move(data)});
  changed_.notify_all();
}

std::vector<std::shared_ptr<const Event>> EventLog::After(std::uint64_t id, double seconds,
                                                          std::size_t most) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                    [&] { return closed_ || last_ > id; });
  std::vector<std::shared_ptr<const Event>> found;
  for (auto event = events_.upper_bound(id); event != events_.end() && found.size() < most;
       ++event) {
    found.push_back(event->second);
  }
  return found;
}

void EventLog::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::uint64_t EventLog::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

}  // namespace abbe::live
