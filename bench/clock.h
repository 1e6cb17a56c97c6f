// What time it is, for benchmarks that are no program of Google Benchmark.
#pragma once

#include <time.h>

#include <chrono>

namespace abbe::bench {

// Time by the clock, s.
inline double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Processor time of this program, s: what others do on the same computer does not count.
inline double ProcessorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace abbe::bench
