// What a CANopen encoder has told about itself, and what the master owes it.
//
// A node is asked for its identity once it is heard (or at once, where no heartbeat is watched),
// compared with the machine file, and started. From then on it answers every SYNC. When it starts
// anew by itself (boot-up, or pre-operational after it was operational) its position reference is
// lost: it is asked and started again, and its counts mean nothing until the reference is
// confirmed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "hal/canopen_frame.h"
#include "hal/canopen_settings.h"

namespace abbe::hal {

class CanopenNode {
 public:
  // `speed`: seconds of the stamps in one second of real time. With `asks` false nothing is asked
  // of the node and nothing is sent to it: it is taken to be there and as described (a replay).
  CanopenNode(const EncoderSettings& encoder, const CanopenTimes& times, double speed, bool asks);

  // Any frame of the bus but PDOs. True when it means that the node has started anew.
  bool Hear(const CanReceived& received);
  // A PDO of the node: only an operational one sends it.
  void HearPdo() { state_ = NmtState::kOperational; }
  // Sends what is due: the next question, or the command to start. `silent`: it has not answered
  // the last SYNC.
  void Act(CanBus& bus, double now_s, bool silent);

  // Started, and not known to be away: its answer to a SYNC is worth waiting for.
  bool Answers(double now_s) const { return started_s_.has_value() && Alive(now_s); }
  // There, and answering what it is asked before it is started.
  bool Starting(double now_s) const;
  bool described() const { return mismatch_.empty(); }
  bool in_emergency() const { return emergency_.has_value(); }
  // What is wrong, in one line: "node 2: no heartbeat for 500 ms"; empty when all is well.
  std::string Fault(double now_s) const;

 private:
  // Objects of CiA 301 and 406 that tell what the counts mean.
  enum Question { kOperating, kPerTurn, kRange, kPhysicalPerTurn, kTurns, kSerial, kQuestions };

  bool Alive(double now_s) const;
  void HearAnswer(const SdoReply& reply);
  void Ask(CanBus& bus, double now_s);
  void Compare();  // the answers with the machine file
  bool HearState(NmtState state);

  EncoderSettings encoder_;
  CanopenTimes times_;
  double speed_;
  bool asks_;
  std::optional<double> heard_s_;  // the last heartbeat
  std::optional<NmtState> state_;
  int question_ = 0;  // kQuestions: all are answered
  std::optional<double> asked_s_;
  bool overdue_ = false;  // the question was asked again
  std::array<std::optional<std::uint32_t>, kQuestions> answers_{};
  std::string mismatch_;
  std::optional<double> started_s_;  // the last command to start
  std::optional<Emergency> emergency_;
};

}  // namespace abbe::hal
