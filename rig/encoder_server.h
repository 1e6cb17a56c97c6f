// The rig on the CAN bus: the encoders of its linkage as CANopen nodes, one for each
// [[devices.NAME.node]] of a device of the machine file, served by a thread.
//
//   hal::SteadyClock clock;
//   const hal::CanopenSettings& device = devices.canopen[0];
//   auto bus = std::make_unique<hal::CanSocket>("vcan0", clock, EncoderServer::HeardIds(device));
//   EncoderServer encoders(machine, device, std::move(bus), clock);
//
// At each SYNC all nodes look at the machine at the same moment. Heartbeats go out every 100 ms. A
// machine that stands out of the linkage's reach makes the nodes say an emergency. A bus that goes
// down is waited for.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "hal/can_bus.h"
#include "hal/canopen_settings.h"
#include "hal/clock.h"
#include "rig/encoder_node.h"
#include "rig/live_machine.h"

namespace abbe::rig {

class EncoderServer {
 public:
  // Serves when it returns. The bus is on `clock`, which must outlive the server, as must the
  // machine. InputError when a node is no pivot of the rig's linkage, or the machine has no
  // linkage; DeviceError when the bus does not work.
  EncoderServer(LiveMachine& machine, const hal::CanopenSettings& device,
                std::unique_ptr<hal::CanBus> bus, hal::Clock& clock);
  ~EncoderServer();
  EncoderServer(const EncoderServer&) = delete;
  EncoderServer& operator=(const EncoderServer&) = delete;

  // The identifiers that its nodes listen to: NMT, SYNC, and the questions to each.
  static std::vector<std::uint32_t> HeardIds(const hal::CanopenSettings& device);

  std::uint64_t syncs() const { return syncs_; }  // heard so far
  // A line for a person: which node has which pivot.
  std::string MapText() const;

 private:
  struct Encoder {
    EncoderNode node;
    Eigen::Index pivot;
  };

  void Serve();
  void Hear(const hal::CanFrame& frame);

  LiveMachine& machine_;
  const hal::CanopenSettings device_;
  std::unique_ptr<hal::CanBus> bus_;
  hal::Clock& clock_;
  std::vector<Encoder> encoders_;
  std::atomic<std::uint64_t> syncs_{0};
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

}  // namespace abbe::rig
