// The one monotonic clock of a measurement, as an interface.
//
// Time is seconds since the clock was made. All samples are stamped by the same clock. Deadlines on
// sockets are in real time instead, because devices answer in real time. Both go on while the
// computer sleeps, and setting its calendar changes neither.
// Units: s.
// Failure: none.
// Source: CLOCK_BOOTTIME of Linux.
// Validity: resolution of the kernel's clock, below 1 us.
#pragma once

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <mutex>
#include <thread>

namespace abbe::hal {

// Real time that never goes back and goes on while the computer sleeps (std::chrono::steady_clock
// stands still then), as a clock of the standard library.
struct BootClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<BootClock>;
  static constexpr bool is_steady = true;
  static time_point now() {
    timespec now{};
    clock_gettime(CLOCK_BOOTTIME, &now);
    return time_point(std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec));
  }
};

class Clock {
 public:
  virtual ~Clock() = default;
  virtual double Now() = 0;
  // Returns when Now() >= time_s.
  virtual void SleepUntil(double time_s) = 0;
  // Returns when Now() >= time_s, or before that when `wake` is notified. `lock` is held before and
  // after.
  virtual void WaitUntil(double time_s, std::unique_lock<std::mutex>& lock,
                         std::condition_variable& wake) = 0;
  // Seconds of this clock in one second of the computer's.
  virtual double speed() const { return 1.0; }
};

// The computer's BootClock, `speed` seconds a second: 1 for real devices, more for a virtual
// machine that runs faster than a real one.
class SteadyClock : public Clock {
 public:
  explicit SteadyClock(double speed = 1.0) : speed_(speed) {}
  double Now() override {
    return speed_ * std::chrono::duration<double>(BootClock::now() - start_).count();
  }
  void SleepUntil(double time_s) override { std::this_thread::sleep_until(RealTime(time_s)); }
  void WaitUntil(double time_s, std::unique_lock<std::mutex>& lock,
                 std::condition_variable& wake) override {
    wake.wait_until(lock, RealTime(time_s));
  }
  double speed() const override { return speed_; }

 private:
  std::chrono::time_point<BootClock, std::chrono::duration<double>> RealTime(double time_s) const {
    return start_ + std::chrono::duration<double>(time_s / speed_);
  }

  double speed_;
  BootClock::time_point start_ = BootClock::now();
};

// A clock that stands still until somebody sleeps on it or moves it: no test waits.
class HandClock : public Clock {
 public:
  double Now() override { return now_s_; }
  void SleepUntil(double time_s) override { now_s_ = time_s > now_s_ ? time_s : now_s_; }
  void WaitUntil(double time_s, std::unique_lock<std::mutex>&, std::condition_variable&) override {
    SleepUntil(time_s);
  }
  void Advance(double by_s) { now_s_ += by_s; }

 private:
  double now_s_ = 0.0;
};

}  // namespace abbe::hal
