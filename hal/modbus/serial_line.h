// A serial line as the machine file describes it.
#pragma once

#include <string>

namespace abbe::hal {

struct SerialLine {
  std::string device;  // "/dev/ttyUSB0"
  int baud = 19200;    // bit/s
  char parity = 'E';   // 'N', 'E' or 'O'
  int stop_bits = 1;   // 1 or 2
};

}  // namespace abbe::hal
