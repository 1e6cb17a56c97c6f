// The contract of sample_source.h on CANopen encoders, over a bus in memory.
#include <numbers>

#include "can_encoder_node.h"
#include "hal/can/canopen_source.h"
#include "sample_source_contract.h"

namespace abbe::hal {
namespace canopen_contract_test {

enum class CanFault { kLost, kLate, kShort, kCorrupt, kEmergency, kSilent, kBusOff, kOverflow };

CanopenSettings ContractEncoders() {
  CanopenSettings settings{.name = "linkage", .interface = "memory", .times = {}, .encoders = {}};
  for (int i = 0; i < 2; ++i) {
    EncoderSettings encoder;
    encoder.name = i == 0 ? "probe_a_um" : "probe_b_um";
    encoder.node = 1 + i;
    encoder.at_bit = 8 * i;
    encoder.range = 65536;
    encoder.counts_per_turn = 2.0 * std::numbers::pi / kStep;
    settings.encoders.push_back(encoder);
  }
  return settings;
}

class CanRig : public ContractRig {
 public:
  explicit CanRig(CanFault fault) : fault_(fault) {
    const CanopenSettings settings = ContractEncoders();
    for (std::size_t i = 0; i < 2; ++i) {
      nodes_.push_back(std::make_unique<CanEncoderNode>(wire_, settings.encoders[i],
                                                        [this, i] { return TrueWord(i, tick_); }));
      nodes_.back()->objects.erase({0x6001, 0});  // no whole number of counts a turn
      nodes_.back()->Beat();
    }
    flood_ = wire_.Join([](const ReceivedFrame&) {});
    source_ = std::make_unique<CanopenSource>(settings, kStale, wire_.Join(), clock_);
    for (auto& node : nodes_) node->Beat();
    source_->Require();
  }
  SampleSource& source() override { return *source_; }
  Clock& clock() override { return clock_; }
  void Tick(int tick) override {
    tick_ = tick;
    clock_.Advance(kTick);
    const bool trouble = tick >= kTroubleFrom && tick < kTroubleTo;
    if (tick == kTroubleFrom) Begin();
    if (tick == kTroubleTo) End();
    if (trouble && fault_ == CanFault::kOverflow) {
      for (int i = 0; i < 300; ++i) flood_->Send({.id = 0x7E5, .size = 1});
    }
    for (auto& node : nodes_) node->Beat();
  }

 private:
  void Begin() {
    using Kind = CanTrouble::Kind;
    for (const std::uint32_t id : {0x181u, 0x182u}) {
      CanTrouble trouble{.id = id};
      if (fault_ == CanFault::kLate) trouble.kind = Kind::kLate;
      if (fault_ == CanFault::kShort) trouble.kind = Kind::kShort;
      if (fault_ == CanFault::kCorrupt) trouble.kind = Kind::kCorrupt;
      trouble.late_s = 5.0;
      trouble.size = 2;
      trouble.mask = 0x8080808080;  // a bit beyond the range
      if (fault_ <= CanFault::kCorrupt) wire_.Inject(trouble);
    }
    for (auto& node : nodes_) {
      if (fault_ == CanFault::kEmergency) node->Say(0x5000);
      if (fault_ == CanFault::kSilent) {
        node->beats = false;
        node->state = NmtState::kStopped;
      }
    }
    if (fault_ == CanFault::kBusOff) wire_.SetState(CanState::kBusOff);
  }
  void End() {
    wire_.Heal();
    wire_.SetState(CanState::kActive);
    for (auto& node : nodes_) {
      if (fault_ == CanFault::kEmergency) node->Say(0);
      node->beats = true;
    }
  }

  CanFault fault_;
  HandClock clock_;
  CanInProcess wire_{clock_, 256};
  int tick_ = 0;
  std::vector<std::unique_ptr<CanEncoderNode>> nodes_;
  std::unique_ptr<CanBus> flood_;
  std::unique_ptr<CanopenSource> source_;
};

std::vector<ContractCase> Cases() {
  const auto make = [](const std::string& name, CanFault fault, Cause cause, bool names_fault,
                       int recovery_ticks) {
    return ContractCase{"Can" + name, [fault] { return std::make_unique<CanRig>(fault); },
                        {cause},      true,
                        names_fault,  recovery_ticks};
  };
  return {make("Lost", CanFault::kLost, Cause::kNoReply, true, 0),
          make("Late", CanFault::kLate, Cause::kNoReply, true, 0),
          make("Short", CanFault::kShort, Cause::kNoReply, true, 0),
          make("Corrupt", CanFault::kCorrupt, Cause::kOutOfRange, false, 0),
          make("Emergency", CanFault::kEmergency, Cause::kSensorFault, true, 0),
          // It takes one reading to start a stopped node again, or to hear that nodes are back.
          make("Silent", CanFault::kSilent, Cause::kNoReply, true, 1),
          make("BusOff", CanFault::kBusOff, Cause::kNoReply, true, 1),
          make("Overflow", CanFault::kOverflow, Cause::kNoReply, true, 1)};
}

INSTANTIATE_TEST_SUITE_P(Can, SampleSourceContract, testing::ValuesIn(Cases()), CaseName);

}  // namespace canopen_contract_test
}  // namespace abbe::hal
