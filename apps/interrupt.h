// A clean end on Ctrl-C and SIGTERM: long work checks a flag between its steps.
#pragma once

#include <atomic>

namespace abbe::apps {

// Installs the handlers at the first call. The flag turns true at the first signal; a second signal
// ends the program at once.
const std::atomic<bool>& InterruptFlag();

}  // namespace abbe::apps
