// The Enter key of the operator, without waiting for it: lines of standard input.
#pragma once

#include "hal/standstill.h"

namespace abbe::apps {

// kStands for a line that has come since the last call, one a call; kEnd when the input has ended
// or Ctrl-C was pressed.
class KeyPress {
 public:
  hal::Confirmation Poll();

 private:
  bool ended_ = false;
};

}  // namespace abbe::apps
