#include "hal/can/can_replay.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "failure/failure.h"

namespace abbe::hal {

CanReplay::CanReplay(const CandumpLog& log, const std::string& interface, Clock& clock)
    : clock_(clock), start_s_(clock.Now()) {
  std::set<std::string> others;
  for (const LoggedFrame& logged : log.frames) {
    if (logged.interface == interface) {
      frames_.push_back({logged.time_s, logged.frame});
    } else {
      others.insert(logged.interface);
    }
  }
  if (!frames_.empty()) return;
  throw InputError(fmt::format(
      "{}: has no frames of {}, but of {}; correct `interface` of the device in the machine file",
      log.name, interface, fmt::join(others, ", ")));
}

double CanReplay::NextTime() const {
  return start_s_ + frames_[std::min(next_, frames_.size() - 1)].time_s;
}

std::optional<ReceivedFrame> CanReplay::Receive(double until_s) {
  if (Ended()) return {};
  const double time = start_s_ + frames_[next_].time_s;
  clock_.SleepUntil(std::min(time, until_s));
  if (clock_.Now() < time) return {};
  return ReceivedFrame{frames_[next_++].frame, time, false};
}

}  // namespace abbe::hal
