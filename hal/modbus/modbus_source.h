// The readings of one Modbus device.
//
// Each Read() requests every block of the device, one request each, and judges every channel. A
// sample is stamped with the middle of its exchange, and was measured within half of the exchange
// before or after it. A block that the device refuses (exception) is bad and the others are still
// read; after any other fault all channels not yet read are bad, too.
// Units: that of each channel; s of the clock.
// Failure: DeviceError from the constructor, Require and StartCycle; else bad samples.
// Source: hal/modbus/modbus_client.h.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/clock.h"
#include "hal/modbus/channel_judge.h"
#include "hal/modbus/modbus_client.h"
#include "hal/transport.h"

namespace abbe::hal {

class ModbusSource : public DeviceSource {
 public:
  // Opens nothing yet. `clock` must outlive the source; `stale_s` as in DevicesSettings.
  // DeviceError when a host name cannot be resolved.
  ModbusSource(const ModbusSettings& device, double stale_s, Clock& clock, Log log = {});

  // A device that is busy is given two seconds to answer every block.
  void Require() override;
  // "modbus", and what the device says of itself.
  std::string Description() const override;

  // The file names a register for it.
  bool HasCycleStart() const override { return device_.cycle_start.has_value(); }
  // Writes `program` to the register that starts it. Exception 5, "acknowledge", is no refusal.
  void StartCycle(int program) override;

  const std::vector<Channel>& channels() const override { return channels_; }
  // Every block once.
  SampleSet Read() override;
  // As the last Read() left it.
  std::string Fault() const override;

  std::uint64_t failures() const { return failures_; }  // readings with a fault, so far
  std::uint64_t connections() const { return client_.connections(); }

 private:
  struct BlockReading {
    std::vector<std::uint16_t> words;
    double time_s = 0.0, within_s = 0.0;
    Cause cause = Cause::kNone;
  };
  void ReadBlocks();
  std::optional<std::uint16_t> StatusOf(const ChannelSettings& channel) const;
  void Note(const std::optional<ModbusFault>& fault);  // counts, and logs a change
  DeviceError Error(const std::string& fault, int exception) const;

  ModbusSettings device_;
  Clock& clock_;
  Log log_;
  ModbusClient client_;
  std::vector<Channel> channels_;
  std::vector<ChannelJudge> judges_;  // in the order of channels_
  std::vector<BlockReading> readings_;
  std::uint64_t sequence_ = 0;
  std::string fault_;
  int exception_ = 0;  // that `fault_` is
  std::string identity_;
  std::uint64_t failures_ = 0;
  std::uint64_t failures_in_a_row_ = 0;
};

}  // namespace abbe::hal
