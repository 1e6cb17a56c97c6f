#include "apps/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace abbe::apps {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// A step may take minutes: a person who pressed Ctrl-C hears that it was heard.
void Acknowledge() {
  constexpr std::string_view kText =
      "\nabbe: ends after what it is at; Ctrl-C once more ends it at once\n";
  if (isatty(STDERR_FILENO) == 0) return;
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kText.data(), kText.size());
}

void Interrupt(int signal) {
  if (interrupted.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  if (signal == SIGINT) Acknowledge();
}

}  // namespace

const std::atomic<bool>& InterruptFlag() {
  static const bool installed = [] {
    struct sigaction action {};
    action.sa_handler = Interrupt;  // no SA_RESTART: blocking calls return, and the flag is checked
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    return true;
  }();
  (void)installed;
  return interrupted;
}

}  // namespace abbe::apps
