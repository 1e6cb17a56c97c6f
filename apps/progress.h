// How far a long job is: a bar with the time left on a terminal, a plain line every tenth
// elsewhere. Written to standard error, so that standard output stays data.
#pragma once

#include <chrono>
#include <string>

namespace abbe::apps {

class Progress {
 public:
  // `title` stands before the bar. A quiet progress prints nothing.
  Progress(std::string title, bool quiet);
  // Ends the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` of `total` steps are done; `note` says what is going on now ("station 12.000 mm, pass 2
  // up"). A bar is redrawn at most ten times a second.
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
