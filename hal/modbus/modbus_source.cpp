#include "hal/modbus/modbus_source.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

namespace abbe::hal {
namespace {

constexpr int kAcknowledge = 5, kBusy = 6;  // exceptions

}  // namespace

ModbusSource::ModbusSource(const ModbusSettings& device, double stale_s, Clock& clock, Log log)
    : device_(device), clock_(clock), log_(std::move(log)), client_(device_) {
  for (const BlockSettings& block : device_.blocks) {
    readings_.push_back({std::vector<std::uint16_t>(block.count)});
    for (const ChannelSettings& channel : block.channels) {
      channels_.push_back({channel.name, device_.name});
      judges_.emplace_back(channel, stale_s);
    }
  }
}

DeviceError ModbusSource::Error(const std::string& fault, int exception) const {
  const std::string remedy =
      exception != 0 ? ExceptionRemedy(exception)
                     : "check that it is on, the link, and its place and unit in the machine file";
  return DeviceError(
      fmt::format("device \"{}\" ({}): {}; {}", device_.name, PlaceOf(device_), fault, remedy));
}

void ModbusSource::Require() {
  constexpr std::chrono::milliseconds kBusyFor{2000}, kAgain{50};
  const auto until = BootClock::now() + kBusyFor;
  while (true) {
    Read();
    const bool busy = exception_ == kAcknowledge || exception_ == kBusy;
    if (!busy || BootClock::now() >= until) break;
    std::this_thread::sleep_for(kAgain);
  }
  if (!fault_.empty()) throw Error(fault_, exception_);
  identity_ = client_.Identity(client_.Deadline());
}

std::string ModbusSource::Description() const {
  return identity_.empty() ? "modbus" : "modbus, " + identity_;
}

void ModbusSource::StartCycle(int program) {
  const auto word = static_cast<std::uint16_t>(program);
  const auto fault = client_.Write(device_.cycle_start->address, word, client_.Deadline());
  if (fault && fault->exception != kAcknowledge) throw Error(fault->text, fault->exception);
}

SampleSet ModbusSource::Read() {
  ReadBlocks();
  SampleSet set;
  set.sequence = ++sequence_;
  set.samples.reserve(channels_.size());
  const double now = clock_.Now();
  std::size_t at = 0;
  for (std::size_t b = 0; b < readings_.size(); ++b) {
    const BlockReading& reading = readings_[b];
    for (const ChannelSettings& channel : device_.blocks[b].channels) {
      ChannelJudge& judge = judges_[at++];
      set.samples.push_back(
          reading.cause != Cause::kNone
              ? judge.Missing(reading.cause, now)
              : judge.Judge(reading.words, StatusOf(channel), reading.time_s, now));
      set.samples.back().within_s = reading.within_s;
    }
  }
  FinishSet(set, now);
  return set;
}

void ModbusSource::ReadBlocks() {
  const auto deadline = client_.Deadline();
  std::optional<ModbusFault> first_fault;
  bool link_lost = false;
  for (std::size_t b = 0; b < readings_.size(); ++b) {
    BlockReading& reading = readings_[b];
    reading.cause = Cause::kNoReply;
    if (link_lost) continue;
    const BlockSettings& block = device_.blocks[b];
    const double start = clock_.Now();
    const auto fault = client_.Read(block.table, block.address, reading.words, deadline);
    const double end = clock_.Now();
    reading.time_s = 0.5 * (start + end);
    reading.within_s = 0.5 * (end - start);
    if (!fault) {
      reading.cause = Cause::kNone;
      continue;
    }
    if (fault->kind == ModbusFault::Kind::kException) reading.cause = Cause::kRefused;
    if (fault->kind == ModbusFault::Kind::kSuspended) reading.cause = Cause::kClockJump;
    link_lost = fault->kind != ModbusFault::Kind::kException;
    if (!first_fault) first_fault = fault;
  }
  Note(first_fault);
}

std::optional<std::uint16_t> ModbusSource::StatusOf(const ChannelSettings& channel) const {
  if (!channel.status) return {};
  for (std::size_t b = 0; b < readings_.size(); ++b) {
    const BlockSettings& block = device_.blocks[b];
    const int at = channel.status->address - block.address;
    if (block.table != channel.status->table || at < 0 || at >= block.count) continue;
    if (readings_[b].cause != Cause::kNone) return {};
    return readings_[b].words[at];
  }
  return {};
}

void ModbusSource::Note(const std::optional<ModbusFault>& first) {
  const std::string fault = first ? first->text : std::string();
  if (!fault.empty()) {
    ++failures_;
    ++failures_in_a_row_;
  }
  if (log_ && fault_.empty() && !fault.empty()) {
    log_(fmt::format("device \"{}\" ({}): {}; its readings are bad until it answers again",
                     device_.name, PlaceOf(device_), fault));
  } else if (log_ && !fault_.empty() && fault.empty()) {
    log_(fmt::format("device \"{}\" ({}): answers again after {} failed readings", device_.name,
                     PlaceOf(device_), failures_in_a_row_));
  }
  if (fault.empty()) failures_in_a_row_ = 0;
  fault_ = fault;
  exception_ = first ? first->exception : 0;
}

std::string ModbusSource::Fault() const {
  return fault_.empty() ? fault_ : fmt::format("device \"{}\": {}", device_.name, fault_);
}

}  // namespace abbe::hal
