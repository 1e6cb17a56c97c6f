// The hands of an operator at the virtual rig: lines of standard input.
//
//   move X 60          an axis to a position of the control, mm
//   turn base_left -0.35   a screw of [align], turns clockwise
//   head Y             the head as for the sweep of an axis
#pragma once

#include <string>

#include "rig/live_machine.h"

namespace abbe::apps {

// InputError for another line, a place beyond the travel, a screw that there is not.
void DoByHand(const std::string& line, rig::LiveMachine& machine);

// Reads the lines that have come, without waiting; a line that is refused is one line on standard
// error.
class RigHands {
 public:
  void Poll(rig::LiveMachine& machine);

 private:
  std::string line_;
  bool ended_ = false;
};

}  // namespace abbe::apps
