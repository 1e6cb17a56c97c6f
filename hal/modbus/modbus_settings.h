// A Modbus device as the machine file describes it: a table [devices.NAME]. Every key, with unit
// and default, is in docs/devices.md.
//
// A channel is a number in the registers of a block: value = raw * scale + offset, in the unit that
// the channel's name ends in ("probe_a_um"). Addresses here are those on the wire, from 0;
// `address_base` of the file is taken off at reading. One block is one request.
//
// The virtual rig encodes with the same channels: StoreValue() is the inverse of RawOf() and
// ValueOf().
// Units: s; values in the unit of the channel's name.
// Failure: InputError with file, line and key.
// Source: docs/devices.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/modbus/modbus_frame.h"
#include "hal/modbus/register_table.h"
#include "hal/modbus/serial_line.h"
#include "hal/modbus/word_codec.h"
#include "settings/document.h"

namespace abbe::hal {

// A register that says whether a channel is valid: (word & mask) must be one of `ok`.
struct StatusRule {
  int address = 0;  // on the wire, in a block of the same device
  RegisterTable table = RegisterTable::kInput;
  std::uint16_t mask = 0xFFFF;
  std::vector<std::uint16_t> ok;
};

struct ChannelSettings {
  std::string name;
  int at = 0;  // first register, counted from the start of the block
  WordType type = WordType::kUint16;
  WordOrder order = WordOrder::kABCD;
  double scale = 1.0;
  double offset = 0.0;
  std::vector<double> sentinels;           // raw numbers that mean "no value"
  std::optional<double> minimum, maximum;  // of the value; outside is out of range
  bool may_freeze = false;                 // an unchanging register is no fault
  std::optional<StatusRule> status;
};

struct BlockSettings {
  RegisterTable table = RegisterTable::kInput;
  int address = 0;
  int count = 1;  // 1 to 125
  std::vector<ChannelSettings> channels;
};

// Seconds.
struct ModbusTimes {
  double response = 0.2;       // from the request to the first byte, and to connect
  double byte = 0.05;          // between two bytes of a reply
  double deadline = 0.5;       // for a reading of all blocks of the device
  double backoff_first = 0.1;  // before the second attempt to reconnect (the first is at once)
  double backoff_most = 1.0;   // doubled up to this
  double wait = 0.0;           // silence between two requests
};

struct CycleStart {
  int address = 0;  // a holding register; abbe writes 1 for X, 2 for Y, 3 for Z to start the sweep
};

struct ModbusSettings {
  std::string name;  // of the device
  ModbusFraming framing = ModbusFraming::kTcp;
  std::string host;   // TCP: a numeric address or a host name
  int port = 502;     // TCP
  SerialLine serial;  // RTU
  int unit = 1;
  ModbusTimes times;
  std::vector<BlockSettings> blocks;
  std::optional<CycleStart> cycle_start;
};

// Reads the table of a device that is reached over TCP or a serial line. InputError with file, line
// and key.
ModbusSettings ReadModbus(const settings::Table& device, ModbusFraming framing);

// `block` holds the registers of the channel's block.
double RawOf(const ChannelSettings& channel, std::span<const std::uint16_t> block);
// raw * scale + offset.
double ValueOf(const ChannelSettings& channel, double raw);
// Stores the raw number nearest to `value`; beyond the ends of an integer type it stays at the end.
void StoreValue(const ChannelSettings& channel, double value, std::span<std::uint16_t> block);

// "127.0.0.1 port 1502, unit 1" or "/dev/ttyUSB0, unit 1".
std::string PlaceOf(const ModbusSettings& device);

}  // namespace abbe::hal
