// CANopen encoders as the machine file describes them: a table [devices.NAME] with one
// [[devices.NAME.node]] for each encoder. Every key, with unit and default, is in docs/devices.md.
//
// An encoder's number is a count that wraps at `range`. angle = sense * (count - zero) * Step().
// CountOf() is the inverse.
// Units: rad, rad/s, s.
// Failure: InputError with file, line and key.
// Source: CiA 406 for the count and its range.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::hal {

struct EncoderSettings {
  std::string name;                     // "pivot_1_rad"
  int node = 1;                         // 1 to 127
  int tpdo = 1;                         // 1 to 4, the PDO that carries the count
  int at_bit = 0;                       // where the count begins in it
  int bits = 32;                        // 1 to 48
  bool is_signed = false;               // two's complement: -range/2 to range/2
  double counts_per_turn = 0.0;         //
  std::int64_t range = 1;               // counts after which the number begins again
  int sense = 1;                        // +1: the angle grows with the count; -1: against it
  std::int64_t zero = 0;                // the count at angle zero
  double fastest = 20.0;                // rad/s; a step beyond it is no motion
  bool may_freeze = true;               // an unchanging count is no fault
  std::optional<std::uint32_t> serial;  // object 1018h:4, to notice a wrong encoder

  double Step() const;  // rad, of one count
};

// Seconds of real time.
struct CanopenTimes {
  double sync = 1e-3;      // at least between two SYNCs; 0: another device sends them
  double answer = 0.02;    // from the SYNC to the last PDO
  double heartbeat = 0.5;  // without a heartbeat the node is lost; 0: not watched
};

struct CanopenSettings {
  std::string name;  // of the device
  std::string interface;
  CanopenTimes times;
  std::vector<EncoderSettings> encoders;
};

// Reads the table of a device. InputError with file, line and key.
CanopenSettings ReadCanopen(const settings::Table& device);

// The count that the encoder sends at this angle (rad): the nearest, wrapped into its range.
std::int64_t CountOf(const EncoderSettings& encoder, double angle);

// `counts` as the nearest to zero of all that are the same modulo the range: -range/2 to range/2.
std::int64_t Wrapped(const EncoderSettings& encoder, std::int64_t counts);

}  // namespace abbe::hal
