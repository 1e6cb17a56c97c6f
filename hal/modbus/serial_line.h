// A serial line as the machine file describes it.
// Units: bit/s.
// Failure: none here; the client says what does not open.
// Source: Modbus over serial line V1.02, 2.5: even parity, 19200 as presets.
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
