#include "apps/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "apps/terminal.h"

namespace abbe::apps {
namespace {

constexpr std::size_t kBarWidth = 24;

}  // namespace

Progress::Progress(std::string title, bool quiet)
    : title_(std::move(title)), quiet_(quiet), terminal_(IsTerminal(stderr)) {}

Progress::~Progress() {
  if (line_open_) fmt::print(stderr, "\n");
}

void Progress::Show(std::size_t done, std::size_t total, const std::string& note) {
  if (quiet_ || total == 0) return;
  const Clock::time_point now = Clock::now();
  const double share = std::min(1.0, done / static_cast<double>(total));
  if (!terminal_) {
    const int tenth = static_cast<int>(share * 10.0);
    if (tenth == last_tenth_) return;
    last_tenth_ = tenth;
    fmt::print(stderr, "{}: {:3.0f} % {}\n", title_, 100.0 * share, note);
    return;
  }
  if (done < total && now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  const double elapsed = std::chrono::duration<double>(now - started_).count();
  const std::string left = share > 0.0 && share < 1.0
                               ? DurationText(elapsed * (1.0 - share) / share) + " left"
                               : DurationText(elapsed);
  const auto filled = static_cast<std::size_t>(share * kBarWidth);
  const std::string line = fmt::format("{} [{:=<{}}{:.<{}}] {:3.0f} % {} {}", title_, "", filled,
                                       "", kBarWidth - filled, 100.0 * share, left, note);
  fmt::print(stderr, "\r{}\x1b[K", line.substr(0, TerminalWidth() - 1));
  std::fflush(stderr);
  line_open_ = true;
}

}  // namespace abbe::apps
