#include "hal/modbus/modbus_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace abbe::hal {
namespace {

using settings::Table;

constexpr double kMostRegisters = 125.0;  // of one request, by the protocol
constexpr double kLastAddress = 65535.0;
constexpr double kFastestBaud = 4e6;  // that Linux knows

RegisterTable ReadTable(const Table& table) {
  return table.Choice("function", {"input", "holding"}) == "input" ? RegisterTable::kInput
                                                                   : RegisterTable::kHolding;
}

template <class Enum>
Enum ReadChoice(const Table& table, const char* key, const std::vector<std::string>& names,
                bool required = false) {
  const auto at = std::find(names.begin(), names.end(), table.Choice(key, names, required));
  return static_cast<Enum>(at - names.begin());
}

// An address as printed in the file, turned into the one on the wire.
int ReadAddress(const Table& table, int base) {
  return static_cast<int>(
             table.Integer("address", {.at_least = 1.0 * base, .at_most = kLastAddress + base})) -
         base;
}

double ReadTime(const Table& table, const char* key, double fallback_ms) {
  return table.Quantity(key, {.fallback = fallback_ms, .above = 0.0, .at_most = 60'000.0});
}

std::uint16_t ReadWord(const Table& table, const char* key, double number) {
  if (number != std::floor(number) || number < 0.0 || number > kLastAddress) {
    throw table.Error(key, fmt::format("{} is not a 16-bit number (0 to 65535)", number));
  }
  return static_cast<std::uint16_t>(number);
}

StatusRule ReadStatus(const Table& table, const BlockSettings& block, int base) {
  StatusRule rule;
  if (table.Has("at") == table.Has("address")) {
    throw table.Error("", "needs either `at` (in this block) or `address`");
  }
  if (table.Has("at")) {
    rule.table = block.table;
    rule.address = block.address + static_cast<int>(table.Integer(
                                       "at", {.at_least = 0.0, .at_most = block.count - 1.0}));
  } else {
    rule.table = ReadTable(table);
    rule.address = ReadAddress(table, base);
  }
  rule.mask = ReadWord(table, "mask", table.Number("mask", {.fallback = kLastAddress}));
  for (const double word : table.Quantities("ok", 0, std::vector<double>{0.0})) {
    rule.ok.push_back(ReadWord(table, "ok", word));
  }
  table.RefuseUnknown();
  return rule;
}

ChannelSettings ReadChannel(const Table& table, const BlockSettings& block, int base) {
  ChannelSettings channel;
  channel.name = table.Text("name");
  channel.type =
      ReadChoice<WordType>(table, "type", {"int16", "uint16", "int32", "uint32", "float32"}, true);
  channel.order = ReadChoice<WordOrder>(table, "order", {"ABCD", "CDAB", "BADC", "DCBA"});
  channel.at =
      static_cast<int>(table.Integer("at", {.at_least = 0.0, .at_most = block.count - 1.0}));
  if (channel.at + static_cast<int>(WordCount(channel.type)) > block.count) {
    throw table.Error("at", fmt::format("lies outside the block of {} registers", block.count));
  }
  channel.scale = table.Number("scale", {.fallback = 1.0});
  if (channel.scale == 0.0) throw table.Error("scale", "must not be 0");
  channel.offset = table.Number("offset", {.fallback = 0.0});
  channel.sentinels = table.Quantities("sentinels", 0, std::vector<double>{});
  if (table.Has("minimum")) channel.minimum = table.Number("minimum");
  if (table.Has("maximum")) channel.maximum = table.Number("maximum");
  channel.may_freeze = table.Truth("may_freeze", false);
  if (const Table status = table.Child("status"); table.Has("status")) {
    channel.status = ReadStatus(status, block, base);
  }
  table.RefuseUnknown();
  return channel;
}

BlockSettings ReadBlock(const Table& table, int base) {
  BlockSettings block;
  block.table = ReadTable(table);
  block.address = ReadAddress(table, base);
  block.count =
      static_cast<int>(table.Integer("count", {.at_least = 1.0, .at_most = kMostRegisters}));
  if (block.address + block.count - 1 > kLastAddress) {
    throw table.Error("count", "reaches beyond the last register, 65535");
  }
  for (const Table& channel : table.Children("channel")) {
    block.channels.push_back(ReadChannel(channel, block, base));
  }
  table.RefuseUnknown();
  return block;
}

SerialLine ReadSerial(const Table& table) {
  SerialLine line;
  line.device = table.Text("device");
  line.baud = static_cast<int>(
      table.Integer("baud", {.fallback = 19200, .above = 0.0, .at_most = kFastestBaud}));
  const std::string parity = table.Choice("parity", {"even", "none", "odd"});
  line.parity = parity == "even" ? 'E' : parity == "none" ? 'N' : 'O';
  line.stop_bits =
      static_cast<int>(table.Integer("stop_bits", {.fallback = 1, .at_least = 1, .at_most = 2}));
  table.RefuseUnknown();
  return line;
}

ModbusTimes ReadTimes(const Table& table, bool serial) {
  ModbusTimes times;
  times.response = ReadTime(table, "response_timeout_ms", 200.0);
  times.byte = ReadTime(table, "byte_timeout_ms", 50.0);
  times.deadline = ReadTime(table, "deadline_ms", 500.0);
  times.backoff_first = ReadTime(table, "backoff_first_ms", 100.0);
  times.backoff_most = ReadTime(table, "backoff_most_ms", 1000.0);
  times.wait = table.Quantity("wait_ms", {.fallback = serial ? 5.0 : 0.0, .at_least = 0.0});
  if (times.deadline < times.response) {
    throw table.Error("deadline_ms", "must not be shorter than response_timeout_ms");
  }
  if (times.backoff_most < times.backoff_first) {
    throw table.Error("backoff_most_ms", "must not be shorter than backoff_first_ms");
  }
  return times;
}

// A status register is read with a block: it must lie in one.
void RequireStatusBlocks(const Table& table, const ModbusSettings& device) {
  const auto covers = [&](const StatusRule& rule) {
    return std::any_of(device.blocks.begin(), device.blocks.end(), [&](const BlockSettings& block) {
      return block.table == rule.table && rule.address >= block.address &&
             rule.address < block.address + block.count;
    });
  };
  for (const BlockSettings& block : device.blocks) {
    for (const ChannelSettings& channel : block.channels) {
      if (!channel.status || covers(*channel.status)) continue;
      throw table.Error("block", fmt::format("the status register of {} lies in no block; add a "
                                             "[[devices.{}.block]] without channels that covers it",
                                             channel.name, device.name));
    }
  }
}

}  // namespace

ModbusSettings ReadModbus(const Table& table, ModbusFraming framing) {
  ModbusSettings device;
  device.name = table.key();
  device.framing = framing;
  const bool serial = framing == ModbusFraming::kRtu;
  if (serial) {
    device.serial = ReadSerial(table.Child("serial"));
  } else {
    device.host = table.Text("host");
    device.port = static_cast<int>(
        table.Integer("port", {.fallback = 502, .at_least = 1, .at_most = kLastAddress}));
  }
  device.unit = static_cast<int>(table.Integer(
      "unit", {.fallback = 1, .at_least = serial ? 1.0 : 0.0, .at_most = serial ? 247.0 : 255.0}));
  device.times = ReadTimes(table, serial);
  const int base =
      static_cast<int>(table.Integer("address_base", {.fallback = 0, .at_least = 0, .at_most = 1}));
  for (const Table& block : table.Children("block")) {
    device.blocks.push_back(ReadBlock(block, base));
  }
  if (device.blocks.empty()) throw table.Error("block", "is missing; a device has at least one");
  if (const Table start = table.Child("cycle_start"); table.Has("cycle_start")) {
    start.Choice("function", {"holding"});
    device.cycle_start = CycleStart{ReadAddress(start, base)};
    start.RefuseUnknown();
  }
  RequireStatusBlocks(table, device);
  return device;
}

double RawOf(const ChannelSettings& channel, std::span<const std::uint16_t> block) {
  return NumberOf(block.subspan(channel.at), channel.type, channel.order);
}

double ValueOf(const ChannelSettings& channel, double raw) {
  return raw * channel.scale + channel.offset;
}

void StoreValue(const ChannelSettings& channel, double value, std::span<std::uint16_t> block) {
  StoreNumber((value - channel.offset) / channel.scale, channel.type, channel.order,
              block.subspan(channel.at));
}

std::string PlaceOf(const ModbusSettings& device) {
  return device.framing == ModbusFraming::kTcp
             ? fmt::format("{} port {}, unit {}", device.host, device.port, device.unit)
             : fmt::format("{}, unit {}", device.serial.device, device.unit);
}

}  // namespace abbe::hal
