#include "rig/register_server.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "rig/rig_channel.h"

namespace abbe::rig {
namespace {

using hal::Answer;
using hal::BlockSettings;
using hal::ChannelSettings;
using hal::ModbusSettings;
using hal::RegisterTable;
using hal::WordType;

// The raw number that says "no value".
double SentinelOf(const ChannelSettings& channel) {
  if (!channel.sentinels.empty()) return channel.sentinels.front();
  switch (channel.type) {
    case WordType::kInt16:
    case WordType::kInt32:
      return -1.0;
    case WordType::kUint16:
      return std::numeric_limits<std::uint16_t>::max();
    case WordType::kUint32:
      return std::numeric_limits<std::uint32_t>::max();
    case WordType::kFloat32:
      break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

void CheckChannels(const std::vector<ModbusSettings>& devices) {
  for (const ModbusSettings& device : devices) {
    for (const BlockSettings& block : device.blocks) {
      for (const ChannelSettings& channel : block.channels) {
        if (ParseChannel(channel.name)) continue;
        throw InputError(
            fmt::format("devices.{}: the rig has no channel \"{}\"; it serves x_mm, y_mm, z_mm, "
                        "probe_a_um to probe_e_um, temp_NAME_c, pass, direction and feed_mm_min",
                        device.name, channel.name));
      }
    }
  }
}

}  // namespace

ServerOptions AddressOf(const hal::DevicesSettings& devices) {
  for (const ModbusSettings& device : hal::SettingsOf<hal::ModbusDevice>(devices)) {
    if (device.framing == hal::ModbusFraming::kTcp) return {device.host, device.port};
  }
  return {};
}

RegisterServer::RegisterServer(LiveMachine& machine, const hal::DevicesSettings& devices,
                               const ServerOptions& options)
    : devices_(hal::SettingsOf<hal::ModbusDevice>(devices)), machine_(machine) {
  CheckChannels(devices_);
  for (const ModbusSettings& device : devices_) {
    const auto claim = [&](RegisterTable table, int address, int count) {
      for (int i = 0; i < count; ++i) {
        if (registers_.emplace(Place{device.unit, table, address + i}, 0).second) continue;
        throw InputError(fmt::format(
            "devices.{}: register {} of unit {} is claimed twice; give each device of the rig a "
            "unit of its own",
            device.name, address + i, device.unit));
      }
    };
    for (const BlockSettings& block : device.blocks) claim(block.table, block.address, block.count);
    if (device.cycle_start) claim(RegisterTable::kHolding, device.cycle_start->address, 2);
  }
  tcp_ = hal::ModbusServer::ListenTcp(options.host, options.port, *this);
}

std::uint64_t RegisterServer::requests() const {
  std::uint64_t sum = tcp_->requests();
  for (const auto& server : rtu_) sum += server->requests();
  return sum;
}

std::string RegisterServer::OpenRtu(const std::string& device_name) {
  for (const ModbusSettings& device : devices_) {
    if (device.name != device_name) continue;
    rtu_.push_back(hal::ModbusServer::OpenPty(device.unit, *this));
    return rtu_.back()->device();
  }
  throw InputError(
      fmt::format("the machine file has no device \"{}\"; name one of its "
                  "[devices.*] tables",
                  device_name));
}

Answer RegisterServer::Read(int unit, RegisterTable table, int address,
                            std::span<std::uint16_t> words) {
  const std::lock_guard lock(mutex_);
  const auto unit_begin = registers_.lower_bound({unit, RegisterTable::kHolding, 0});
  if (unit_begin == registers_.end() || std::get<0>(unit_begin->first) != unit)
    return Answer::kNoSuchUnit;
  const auto begin = registers_.find({unit, table, address});
  auto found = begin;
  for (std::size_t i = 0; i < words.size(); ++i, ++found) {
    const Place place{unit, table, address + static_cast<int>(i)};
    if (found == registers_.end() || found->first != place) return Answer::kIllegalAddress;
  }
  Refresh();
  found = begin;
  for (std::uint16_t& word : words) word = (found++)->second;
  return Answer::kOk;
}

Answer RegisterServer::Write(int unit, int address, std::span<const std::uint16_t> words) {
  for (const ModbusSettings& device : devices_) {
    if (device.unit != unit || !device.cycle_start || device.cycle_start->address != address) {
      continue;
    }
    if (words.size() != 1) return Answer::kIllegalValue;
    const StartOutcome outcome = machine_.Start(words[0] - 1);
    if (outcome == StartOutcome::kBusy) return Answer::kBusy;
    return outcome == StartOutcome::kStarted ? Answer::kOk : Answer::kIllegalValue;
  }
  return Answer::kIllegalAddress;
}

std::vector<std::string> RegisterServer::Identity(int) {
  return {"abbe", "virtual rig (simulated)"};
}

void RegisterServer::Refresh() {
  const Moment now = machine_.Now();
  for (const ModbusSettings& device : devices_) {
    for (const BlockSettings& block : device.blocks) RefreshBlock(device, block, now);
    if (!device.cycle_start) continue;
    const int address = device.cycle_start->address;
    registers_[{device.unit, RegisterTable::kHolding, address}] =
        static_cast<std::uint16_t>(now.state == ProgramState::kRunning ? now.program + 1 : 0);
    registers_[{device.unit, RegisterTable::kHolding, address + 1}] =
        static_cast<std::uint16_t>(now.state);
  }
  RefreshStatus(now);
}

void RegisterServer::RefreshBlock(const ModbusSettings& device, const BlockSettings& block,
                                  const Moment& now) {
  std::vector<std::uint16_t> words(block.count);
  for (const ChannelSettings& channel : block.channels) {
    const std::optional<double> value = machine_.ReadingOf(channel.name, now);
    if (value) {
      hal::StoreValue(channel, *value, words);
    } else {
      hal::StoreNumber(SentinelOf(channel), channel.type, channel.order,
                       std::span(words).subspan(channel.at));
    }
  }
  auto found = registers_.find({device.unit, block.table, block.address});
  for (const std::uint16_t word : words) (found++)->second = word;
}

// A register that several channels share is bad when one of them is.
void RegisterServer::RefreshStatus(const Moment& now) {
  for (const bool good : {true, false}) {
    for (const ModbusSettings& device : devices_) {
      for (const BlockSettings& block : device.blocks) {
        for (const ChannelSettings& channel : block.channels) {
          if (!channel.status || machine_.ReadingOf(channel.name, now).has_value() != good)
            continue;
          const auto& [address, table, mask, ok] = *channel.status;
          const std::uint16_t first_ok = ok.empty() ? 0 : ok.front();
          std::uint16_t& word = registers_[{device.unit, table, address}];
          word =
              static_cast<std::uint16_t>((word & ~mask) | ((good ? first_ok : ~first_ok) & mask));
        }
      }
    }
  }
}

std::string RegisterServer::MapText() const {
  std::string text;
  for (const ModbusSettings& device : devices_) {
    for (const BlockSettings& block : device.blocks) {
      text += fmt::format("  unit {} {} registers {} to {} ({}):", device.unit,
                          block.table == RegisterTable::kInput ? "input" : "holding", block.address,
                          block.address + block.count - 1, device.name);
      for (const ChannelSettings& channel : block.channels) text += " " + channel.name;
      text += "\n";
    }
    if (!device.cycle_start) continue;
    text += fmt::format(
        "  unit {} holding register {}: write 1, 2, 3 to sweep X, Y, Z{}; {}: 0 idle, 1 running, "
        "2 done\n",
        device.unit, device.cycle_start->address,
        machine_.has_course() ? ", 4 to run the course" : "", device.cycle_start->address + 1);
  }
  return text;
}

}  // namespace abbe::rig
