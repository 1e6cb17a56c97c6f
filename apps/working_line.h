// A sign of life of a long computation: one line on a terminal that says what is being done, which
// step it is and for how long, renewed once a second and erased in the end. Written to standard
// error; nothing where that is no terminal.
#pragma once

#include <memory>
#include <string>

namespace abbe::apps {

// Shows the steps (failure/progress.h) of the thread that makes it, as long as it exists. It
// appears after a second, so that short work shows none.
class WorkingLine {
 public:
  // "fuse": what is being done. Shows nothing if quiet.
  WorkingLine(const std::string& title, bool quiet);
  ~WorkingLine();
  WorkingLine(const WorkingLine&) = delete;
  WorkingLine& operator=(const WorkingLine&) = delete;

  // Erases the line that is shown, if any, before something else is written to standard error.
  static void Erase();

 private:
  class Shown;
  std::unique_ptr<Shown> shown_;
};

}  // namespace abbe::apps
