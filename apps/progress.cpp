#include "apps/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace abbe::apps {
namespace {

constexpr std::size_t kBarWidth = 24;

std::string Duration(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  return whole < 60 ? fmt::format("{} s", whole)
                    : fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

}  // namespace

Progress::Progress(std::string title, bool quiet)
    : title_(std::move(title)), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

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
                               ? Duration(elapsed * (1.0 - share) / share) + " left"
                               : Duration(elapsed);
  const auto filled = static_cast<std::size_t>(share * kBarWidth);
  fmt::print(stderr, "\r{} [{:=<{}}{:.<{}}] {:3.0f} % {} {}\x1b[K", title_, "", filled, "",
             kBarWidth - filled, 100.0 * share, left, note);
  std::fflush(stderr);
  line_open_ = true;
}

}  // namespace abbe::apps
