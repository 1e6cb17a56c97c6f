#include "apps/working_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "apps/terminal.h"
#include "failure/progress.h"

namespace abbe::apps {
namespace {

using WorkingClock = std::chrono::steady_clock;

std::mutex line_mutex;  // of standard error
std::size_t line_length = 0;

void DrawLine(const std::string& text) {
  const std::lock_guard lock(line_mutex);
  fmt::print(stderr, "\r{:<{}}\r", text, std::max(text.size(), line_length));
  std::fflush(stderr);
  line_length = text.size();
}

}  // namespace

class WorkingLine::Shown {
 public:
  explicit Shown(std::string title)
      : title_(std::move(title)),
        to_([this](std::size_t done, std::size_t total, const std::string& what) {
          Hear(done, total, what);
        }),
        thread_([this](const std::stop_token& stop) { Renew(stop); }) {}

 private:
  void Hear(std::size_t done, std::size_t total, const std::string& what) {
    const std::lock_guard lock(mutex_);
    done_ = done;
    total_ = total;
    what_ = what;
  }

  // More steps may turn out to be needed: how long they take nobody knows. A narrow terminal cuts
  // what is being done.
  std::string Text() {
    const std::lock_guard lock(mutex_);
    const auto elapsed = std::chrono::duration<double>(WorkingClock::now() - started_).count();
    const std::string step =
        total_ == 0 ? "working"
                    : fmt::format("{} (step {} of {})", what_, std::min(done_ + 1, total_), total_);
    const std::string time = fmt::format(", {}", DurationText(elapsed));
    const std::size_t room = TerminalWidth() - 1;
    return fmt::format("{}: {}", title_, step).substr(0, room - std::min(room, time.size())) + time;
  }

  void Renew(const std::stop_token& stop) {
    std::mutex waiting;
    std::unique_lock lock(waiting);
    std::condition_variable_any woken;
    const auto second = std::chrono::seconds(1);
    while (!woken.wait_for(lock, stop, second, [&] { return stop.stop_requested(); })) {
      DrawLine(Text());
    }
  }

  std::string title_;
  std::mutex mutex_;
  std::size_t done_ = 0, total_ = 0;
  std::string what_;
  WorkingClock::time_point started_ = WorkingClock::now();
  ProgressTo to_;
  std::jthread thread_;
};

WorkingLine::WorkingLine(const std::string& title, bool quiet) {
  if (!quiet && IsTerminal(stderr)) shown_ = std::make_unique<Shown>(title);
}

WorkingLine::~WorkingLine() {
  if (!shown_) return;
  shown_.reset();
  Erase();
}

void WorkingLine::Erase() {
  const std::lock_guard lock(line_mutex);
  if (line_length == 0) return;
  fmt::print(stderr, "\r{:<{}}\r", "", line_length);
  std::fflush(stderr);
  line_length = 0;
}

}  // namespace abbe::apps
