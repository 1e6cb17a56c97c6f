// The rig as a Modbus server: serves the live machine over TCP, and single devices over RTU on a
// pseudo terminal, by the channel maps of the machine file.
//
//   RegisterServer rig(machine, devices, {.port = 0});
//   rig.port();
//
// Registers: those of the blocks of [devices.*]; a register of a block without a channel reads 0. A
// gap out of range reads the channel's first sentinel, without sentinels all ones (NaN for
// float32), as an amplifier does, and its status register, if it has one, is not `ok`. Otherwise a
// status register shows the first `ok`. Where a device has `cycle_start`, writing 1, 2 or 3 there
// starts the sweep of X, Y or Z, writing 4 the machine's course (busy, exception 6, while one runs;
// illegal value, 3, when none is programmed), and the register after it shows the program: 0 idle,
// 1 running, 2 done.
//
// All TCP devices of the file are served on one address, each by its unit. The device
// identification (function 43) says that the rig is simulated.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "hal/device_settings.h"
#include "hal/modbus/modbus_device.h"
#include "hal/modbus/modbus_server.h"
#include "rig/live_machine.h"

namespace abbe::rig {

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  // 0: a free one
};

// Host and port of the first TCP device of a machine file; without one the default.
ServerOptions AddressOf(const hal::DevicesSettings& devices);

class RegisterServer : private hal::RegisterBank {
 public:
  // Listens when it returns. DeviceError when the address is taken; InputError when the rig lacks a
  // channel of a device, or when two devices claim a register of one unit. `machine` must outlive
  // it.
  RegisterServer(LiveMachine& machine, const hal::DevicesSettings& devices,
                 const ServerOptions& options);

  int port() const { return tcp_->port(); }
  std::uint64_t requests() const;

  // Serves a device of the file over RTU too; returns the terminal a client opens. InputError for
  // an unknown device.
  std::string OpenRtu(const std::string& device);

  // A few lines for a person: which unit, function and registers hold which channels.
  std::string MapText() const;

 private:
  using Place = std::tuple<int, hal::RegisterTable, int>;  // unit, table, address

  hal::Answer Read(int unit, hal::RegisterTable table, int address,
                   std::span<std::uint16_t> words) override;
  hal::Answer Write(int unit, int address, std::span<const std::uint16_t> words) override;
  std::vector<std::string> Identity(int unit) override;
  void Refresh();
  void RefreshBlock(const hal::ModbusSettings& device, const hal::BlockSettings& block,
                    const Moment& now);
  void RefreshStatus(const Moment& now);

  const std::vector<hal::ModbusSettings> devices_;
  LiveMachine& machine_;
  std::mutex mutex_;  // of the registers
  std::map<Place, std::uint16_t> registers_;
  std::vector<std::unique_ptr<hal::ModbusServer>> rtu_;
  std::unique_ptr<hal::ModbusServer> tcp_;  // last: stops before the rest goes
};

}  // namespace abbe::rig
