// The rig on the CAN bus: the encoders of its linkage as CANopen nodes, one for each
// [[devices.NAME.node]] of a device of the machine file.
//
//   const auto device = hal::SettingsOf<hal::CanopenDevice>(devices).front();
//   auto bus = std::make_unique<hal::CanSocket>("vcan0", clock, LinkageEncoders::HeardIds(device));
//   EncoderServer encoders(machine, device, std::move(bus), clock);
//
// At each SYNC all nodes read the machine at the same moment. While the ball is out of the
// linkage's reach they send an emergency.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "hal/can/can_bus.h"
#include "hal/can/canopen_settings.h"
#include "hal/clock.h"
#include "hal/device_settings.h"
#include "rig/encoder_node.h"
#include "rig/live_machine.h"

namespace abbe::rig {

// The nodes of one device; the owner passes on frames (Hear) and calls Beat.
class LinkageEncoders {
 public:
  // `machine` must outlive them. InputError when a node has the name of no pivot of the rig's
  // linkage, or the machine has no linkage.
  LinkageEncoders(LiveMachine& machine, const hal::CanopenSettings& device,
                  const EncoderNode::Send& send);

  void Boot();
  void Beat();
  void Hear(const hal::CanFrame& frame);

  // The identifiers that they listen to: NMT, SYNC, and the questions to each.
  static std::vector<std::uint32_t> HeardIds(const hal::CanopenSettings& device);

  std::uint64_t syncs() const { return syncs_; }  // heard so far; from any thread

 private:
  struct Encoder {
    EncoderNode node;
    Eigen::Index pivot;
  };

  LiveMachine& machine_;
  std::vector<Encoder> encoders_;
  std::atomic<std::uint64_t> syncs_{0};
};

// A thread that serves them on a bus: heartbeats every 100 ms; when the bus goes down it waits for
// it.
class EncoderServer {
 public:
  // Serves when it returns. The bus is on `clock`, which must outlive the server. DeviceError when
  // the bus does not work.
  EncoderServer(LiveMachine& machine, const hal::CanopenSettings& device,
                std::unique_ptr<hal::CanBus> bus, hal::Clock& clock);
  ~EncoderServer();
  EncoderServer(const EncoderServer&) = delete;
  EncoderServer& operator=(const EncoderServer&) = delete;

  std::uint64_t syncs() const { return encoders_.syncs(); }
  // A line for each node, for a person.
  std::string MapText() const;

 private:
  void Serve();

  const hal::CanopenSettings device_;
  std::unique_ptr<hal::CanBus> bus_;
  hal::Clock& clock_;
  LinkageEncoders encoders_;
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

// A server for each device with CANopen encoders, on the computer's CAN interface of that name, or
// that of the device where it is empty.
std::vector<std::unique_ptr<EncoderServer>> ServeEncoders(LiveMachine& machine,
                                                          const hal::DevicesSettings& devices,
                                                          const std::string& interface,
                                                          hal::Clock& clock);

}  // namespace abbe::rig
