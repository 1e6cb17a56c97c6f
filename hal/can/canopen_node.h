// The state of one CANopen encoder: its identity, and the next request of the master to it.
//
// The node's identity is read at its first heartbeat (or at once, where no heartbeat is monitored)
// and compared with the machine file; then the node is started and answers every SYNC. When it
// restarts by itself (boot-up, or pre-operational after it was operational) its position reference
// is lost: it is identified and started again, and its counts are invalid until the reference is
// confirmed.
// Units: s of the clock.
// Failure: none is thrown; Fault() says it.
// Source: CiA 301: NMT, heartbeat, identity object 1018h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "hal/can/canopen_frame.h"
#include "hal/can/canopen_settings.h"

namespace abbe::hal {

class CanopenNode {
 public:
  // `speed`: seconds of the stamps in one second of real time. With `asks` false nothing is sent to
  // the node: it is assumed to be present and as described (a replay).
  CanopenNode(const EncoderSettings& encoder, const CanopenTimes& times, double speed, bool asks);

  // Takes any frame of the bus but PDOs. True when it shows that the node has restarted.
  bool Hear(const ReceivedFrame& received);
  // A PDO of the node: only an operational one sends it.
  void HearPdo() { state_ = NmtState::kOperational; }
  // Sends the next request if one is due: a question, or the command to start. `silent`: it has not
  // answered the last SYNC.
  void Act(CanBus& bus, double now_s, bool silent);

  // Started, and not known to be lost: an answer to a SYNC is expected.
  bool Answers(double now_s) const { return started_s_.has_value() && Alive(now_s); }
  // Alive and answering questions, but not started yet.
  bool Starting(double now_s) const;
  bool described() const { return mismatch_.empty(); }
  bool in_emergency() const { return emergency_.has_value(); }
  // The fault in one line: "node 2: no heartbeat for 500 ms"; empty when there is none.
  std::string Fault(double now_s) const;

 private:
  // Objects of CiA 301 and 406 that define the counts.
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
  bool overdue_ = false;  // the question was repeated
  std::array<std::optional<std::uint32_t>, kQuestions> answers_{};
  std::string mismatch_;
  std::optional<double> started_s_;  // the last command to start
  std::optional<Emergency> emergency_;
};

}  // namespace abbe::hal
