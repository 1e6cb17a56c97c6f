// What a CANopen node says (`hal/can/canopen_node.h`). Each frame of the input has 14 bytes: a time
// step in milliseconds, the identifier (11 bits) with two flags, the size, the place and number of
// bits of a value, the data.
#include <algorithm>

#include "fuzz/target.h"
#include "hal/can/canopen_node.h"

namespace abbe::fuzz::canopen {

constexpr std::size_t kRecord = 14;

// A bus that takes every frame; what a master sends has to be a frame.
class Sink : public hal::CanBus {
 public:
  bool Send(const hal::CanFrame& frame) override {
    Require(frame.size <= 8 && frame.id < 0x800, "what is sent is a frame");
    return true;
  }
  std::optional<hal::ReceivedFrame> Receive(double) override { return {}; }
  hal::CanState state() const override { return hal::CanState::kActive; }
  std::string Fault() const override { return {}; }
  std::uint64_t lost() const override { return 0; }
  std::uint64_t errors() const override { return 0; }
};

void CheckBits(hal::CanFrame frame, int at, int bits) {
  for (const bool is_signed : {false, true}) {
    const auto number = hal::TakeBits(frame, at, bits, is_signed);
    if (!number) continue;
    const hal::CanFrame before = frame;
    hal::PutBits(frame, at, bits, *number);
    Require(frame == before, "bits that are taken and put back change nothing");
  }
}

void Read(Bytes bytes) {
  hal::EncoderSettings encoder;
  encoder.name = "pivot_1_rad";
  encoder.node = 3;
  encoder.counts_per_turn = 65536.0;
  encoder.range = 65536;
  encoder.serial = 7;
  hal::CanopenNode node(encoder, {}, 1.0, true);
  Sink bus;
  double now = 0.0;
  for (; bytes.size() >= kRecord; bytes = bytes.subspan(kRecord)) {
    now += 1e-3 * bytes[0];
    hal::CanFrame frame{.id = static_cast<std::uint32_t>((bytes[1] & 7) << 8 | bytes[2]),
                        .extended = (bytes[1] & 8) != 0,
                        .remote = (bytes[1] & 16) != 0,
                        .size = static_cast<std::uint8_t>(bytes[3] % 9)};
    std::copy_n(bytes.begin() + 6, 8, frame.data.begin());
    CheckBits(frame, bytes[4] % 64, 1 + bytes[5] % 48);
    if (node.Hear({frame, now, false})) Require(!node.Answers(now), "a node anew is not started");
    node.HearPdo();
    node.Act(bus, now, (bytes[1] & 32) != 0);
    Require(node.Fault(now).find('\n') == std::string::npos, "a fault is one line");
  }
}

}  // namespace abbe::fuzz::canopen
