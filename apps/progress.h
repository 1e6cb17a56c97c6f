// The progress of a long job: a bar with the remaining time on a terminal, else a plain line every
// tenth. Written to standard error, so that standard output has data only.
#pragma once

#include <chrono>
#include <string>

namespace abbe::apps {

class Progress {
 public:
  // `title` is printed before the bar. Prints nothing if quiet.
  Progress(std::string title, bool quiet);
  // Ends the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` of `total` steps are done; `note` is the current step ("station 12.000 mm, pass 2 up").
  // A bar is redrawn at most ten times a second.
  void Show(std::size_t done, std::size_t total, const std::string& note);

 private:
  using Clock = std::chrono::steady_clock;
  std::string title_;
  bool quiet_;
  bool terminal_;
  bool line_open_ = false;
  int last_tenth_ = -1;
  Clock::time_point started_ = Clock::now();
  Clock::time_point drawn_{};
};

}  // namespace abbe::apps
