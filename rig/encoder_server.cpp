#include "rig/encoder_server.h"

#include <fmt/format.h>

#include "failure/failure.h"
#include "hal/can/can_socket.h"
#include "hal/can/canopen_device.h"

namespace abbe::rig {
namespace {

constexpr std::uint32_t kNmt = 0x000, kSync = 0x080, kSdoRequest = 0x600;
constexpr double kHeartbeat = 0.1;  // s of real time, as in object 1017h

// 0, 1, 2 of "pivot_1_rad" ...
Eigen::Index PivotOf(const hal::CanopenSettings& device, const hal::EncoderSettings& encoder) {
  for (Eigen::Index pivot = 0; pivot < kPivots; ++pivot) {
    if (encoder.name == fmt::format("pivot_{}_rad", pivot + 1)) return pivot;
  }
  throw InputError(fmt::format(
      "devices.{}: the rig has no encoder \"{}\"; its linkage has pivot_1_rad to pivot_{}_rad",
      device.name, encoder.name, kPivots));
}

}  // namespace

LinkageEncoders::LinkageEncoders(LiveMachine& machine, const hal::CanopenSettings& device,
                                 const EncoderNode::Send& send)
    : machine_(machine) {
  if (!machine_.has_linkage()) {
    throw InputError(fmt::format(
        "devices.{}: encoders without a linkage; add a table [linkage] to the machine file",
        device.name));
  }
  for (const hal::EncoderSettings& encoder : device.encoders) {
    encoders_.push_back({EncoderNode(encoder, send), PivotOf(device, encoder)});
  }
}

std::vector<std::uint32_t> LinkageEncoders::HeardIds(const hal::CanopenSettings& device) {
  std::vector<std::uint32_t> ids{kNmt, kSync};
  for (const hal::EncoderSettings& encoder : device.encoders) {
    ids.push_back(kSdoRequest + encoder.node);
  }
  return ids;
}

void LinkageEncoders::Boot() {
  for (Encoder& encoder : encoders_) encoder.node.Boot();
}

void LinkageEncoders::Beat() {
  for (Encoder& encoder : encoders_) encoder.node.Beat();
}

void LinkageEncoders::Hear(const hal::CanFrame& frame) {
  if (frame.id != kSync || frame.extended || frame.remote) {
    for (Encoder& encoder : encoders_) encoder.node.Hear(frame);
    return;
  }
  ++syncs_;
  const auto angles = machine_.EncodersNow();
  for (Encoder& encoder : encoders_) {
    encoder.node.Sync(angles ? std::optional((*angles)[encoder.pivot]) : std::nullopt);
  }
}

EncoderServer::EncoderServer(LiveMachine& machine, const hal::CanopenSettings& device,
                             std::unique_ptr<hal::CanBus> bus, hal::Clock& clock)
    : device_(device),
      bus_(std::move(bus)),
      clock_(clock),
      encoders_(machine, device, [this](const hal::CanFrame& frame) { bus_->Send(frame); }) {
  if (!hal::Works(bus_->state())) {
    throw DeviceError(fmt::format("devices.{}: {}", device_.name, bus_->Fault()));
  }
  thread_ = std::thread([this] { Serve(); });
}

EncoderServer::~EncoderServer() {
  stopped_ = true;
  thread_.join();
}

void EncoderServer::Serve() {
  encoders_.Boot();
  double beat_s = clock_.Now();
  while (!stopped_) {
    const auto received = bus_->Receive(beat_s);
    if (received && !received->own) encoders_.Hear(received->frame);
    if (received && received->time_s < beat_s) continue;
    if (!hal::Works(bus_->state())) clock_.SleepUntil(clock_.Now() + kHeartbeat * clock_.speed());
    encoders_.Beat();
    beat_s = clock_.Now() + kHeartbeat * clock_.speed();
  }
}

std::string EncoderServer::MapText() const {
  std::string text;
  for (const hal::EncoderSettings& encoder : device_.encoders) {
    text += fmt::format("  {} node {}: {}, {} counts a turn ({})\n", device_.interface,
                        encoder.node, encoder.name, encoder.counts_per_turn, device_.name);
  }
  return text;
}

std::vector<std::unique_ptr<EncoderServer>> ServeEncoders(LiveMachine& machine,
                                                          const hal::DevicesSettings& devices,
                                                          const std::string& interface,
                                                          hal::Clock& clock) {
  std::vector<std::unique_ptr<EncoderServer>> servers;
  for (hal::CanopenSettings& device : hal::SettingsOf<hal::CanopenDevice>(devices)) {
    if (!interface.empty()) device.interface = interface;
    auto bus = std::make_unique<hal::CanSocket>(device.interface, clock,
                                                LinkageEncoders::HeardIds(device));
    servers.push_back(std::make_unique<EncoderServer>(machine, device, std::move(bus), clock));
  }
  return servers;
}

}  // namespace abbe::rig
