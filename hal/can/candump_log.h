// Logs of CAN traffic as `candump -l` and `candump -L` of can-utils write them, and canplayer reads
// them.
//
//   (1763716800.250103) can0 181#DEADBEEF      11 bits of identifier: three digits
//   (1763716800.250249) can0 12345678#01       29 bits: eight digits
//   (1763716800.250390) can0 182#R             a remote request
//
// The stamp is seconds since 1970, to the microsecond. A letter R or T behind the frame (candump
// -x) is passed over; so are error frames and CAN FD frames (##), which are counted.
// Units: s, microseconds where a name says so.
// Failure: InputError with file and line.
// Source: can-utils, candump.c and canplayer.c.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hal/can/can_bus.h"

namespace abbe::hal {

struct LoggedFrame {
  double time_s;  // since the log began
  std::string interface;
  CanFrame frame;
};

struct CandumpLog {
  std::string name;             // the file, for messages
  std::int64_t started_us = 0;  // since 1970: the stamp of the first frame
  std::vector<LoggedFrame> frames;
  std::uint64_t passed_over = 0;      // error frames and frames of CAN FD
  std::vector<std::string> warnings;  // a last line that is cut short, stamps that go back
};

// InputError with file and line for a line of another form, and for a file without frames. A stamp
// before the one ahead of it (the calendar was set back) is taken as equal to that, with a warning.
CandumpLog ReadCandump(const std::filesystem::path& path);

// Failures are those of recording/whole_file.h.
void WriteCandump(const CandumpLog& log, const std::filesystem::path& path);

}  // namespace abbe::hal
