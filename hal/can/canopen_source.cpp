#include "hal/can/canopen_source.h"

#include <fmt/format.h>

#include <algorithm>

namespace abbe::hal {
namespace {

constexpr double kStartTime = 2.0;  // s, for all nodes to be identified and started

bool IsSync(const CanFrame& frame) {
  return frame.id == kSyncId && !frame.extended && !frame.remote;
}

}  // namespace

CanopenSource::CanopenSource(const CanopenSettings& settings, double stale_s,
                             std::unique_ptr<CanBus> bus, Clock& clock, Log log, Part part)
    : settings_(settings),
      bus_(std::move(bus)),
      clock_(clock),
      log_(std::move(log)),
      part_(part),
      sent_s_(clock.Now() - settings.times.sync) {
  const bool asks = part == Part::kMaster;
  for (const EncoderSettings& encoder : settings_.encoders) {
    encoders_.push_back({encoder,
                         CanopenNode(encoder, settings_.times, clock.speed(), asks),
                         EncoderJudge(encoder, stale_s),
                         {}});
    channels_.push_back({encoder.name, settings_.name});
  }
}

DeviceError CanopenSource::Error(const std::string& fault) const {
  return DeviceError(
      fmt::format("device \"{}\" ({}): {}; check that the bus is up, its ends, and the nodes "
                  "with their ids in the machine file",
                  settings_.name, settings_.interface, fault));
}

void CanopenSource::Require() {
  const double until = clock_.Now() + Span(kStartTime + settings_.times.heartbeat);
  while (!Read().AllGood()) {
    if (!Works(bus_->state()) || clock_.Now() >= until) {
      throw Error(fault_.empty() ? "no good reading" : fault_);
    }
  }
}

void CanopenSource::ConfirmReference() {
  for (Encoder& encoder : encoders_) encoder.judge.ConfirmReference();
}

SampleSet CanopenSource::Read() {
  for (Encoder& encoder : encoders_) {
    encoder.answer.reset();
    encoder.too_short = false;
  }
  sync_s_.reset();
  const bool answers_doubled = foreign_sync_;
  foreign_sync_ = false;
  if (part_ == Part::kMaster) {
    Listen(clock_.Now());
    AwaitLateAnswers(answers_doubled);
    Command();
  }
  Collect();

  SampleSet set;
  set.sequence = ++sequence_;
  const double now = clock_.Now();
  lost_now_ = bus_->lost() - lost_before_;
  lost_before_ = bus_->lost();
  const bool torn = lost_now_ > 0 || foreign_sync_;
  for (Encoder& encoder : encoders_) set.samples.push_back(SampleOf(encoder, torn, now));
  FinishSet(set, now);
  Note(FaultNow(now));
  return set;
}

void CanopenSource::Listen(double until_s) {
  const double most = until_s + Span(settings_.times.answer);  // on a bus with endless frames
  while (const auto received = bus_->Receive(until_s)) {
    Hear(*received);
    if (clock_.Now() > most) return;
  }
}

void CanopenSource::AwaitLateAnswers(bool doubled) {
  double until = sent_s_ + Span(2.0 * settings_.times.answer);
  const auto owes = [](const Encoder& encoder) { return encoder.owes; };
  while (doubled || sync_due_ || std::any_of(encoders_.begin(), encoders_.end(), owes)) {
    const bool was_due = sync_due_;
    const auto received = bus_->Receive(until);
    if (!received) break;
    Hear(*received);
    if (!was_due || sync_due_) continue;
    // The SYNC itself was late: so are its answers, which are discarded.
    sync_s_.reset();
    until += Span(2.0 * settings_.times.answer);
    for (Encoder& encoder : encoders_) encoder.owes = encoder.node.Answers(clock_.Now());
  }
  sync_due_ = false;
  for (Encoder& encoder : encoders_) encoder.owes = false;
}

void CanopenSource::Command() {
  if (!Works(bus_->state())) return;
  const double now = clock_.Now();
  for (Encoder& encoder : encoders_) encoder.node.Act(*bus_, now, encoder.silent);
  if (!produces()) return;
  const auto answers = [now](const Encoder& encoder) { return encoder.node.Answers(now); };
  if (std::none_of(encoders_.begin(), encoders_.end(), answers)) return;
  // The first SYNC is for all that are there.
  const auto starting = [now](const Encoder& encoder) { return encoder.node.Starting(now); };
  if (!sync_heard_ && std::any_of(encoders_.begin(), encoders_.end(), starting)) return;
  const double due_s = sent_s_ + settings_.times.sync;
  sent_s_ = now;
  if (now < due_s) {
    Listen(due_s);
    sent_s_ = clock_.Now();
  }
  sync_due_ = bus_->Send(SyncFrame());
}

bool CanopenSource::Complete(double now_s) const {
  bool any = false;
  for (const Encoder& encoder : encoders_) {
    any = any || encoder.answer;
    if (!encoder.answer && encoder.node.Answers(now_s)) return false;
  }
  return any;
}

void CanopenSource::Collect() {
  constexpr double kBetweenCycles = 1.0;      // s, that a listener waits for the next one
  constexpr double kBetweenQuestions = 0.01;  // s, while no node has been started
  const double answer = Span(settings_.times.answer);
  double now = sync_due_ ? sent_s_ : clock_.Now();
  double until = now + (sync_due_    ? answer
                        : produces() ? Span(kBetweenQuestions)
                                     : Span(kBetweenCycles));
  bool begun = produces();
  while (!Complete(now) && Works(bus_->state())) {
    std::optional<ReceivedFrame> received;
    std::swap(received, ahead_);
    if (!received) received = bus_->Receive(until);
    if (!received) break;
    now = received->time_s;
    if (Hear(*received) == Cycle::kNext) {
      ahead_ = received;
      break;
    }
    const bool begins = sync_s_ || std::any_of(encoders_.begin(), encoders_.end(),
                                               [](const Encoder& e) { return e.answer; });
    if (begun || !begins) continue;
    begun = true;
    until = clock_.Now() + answer;
  }
}

CanopenSource::Cycle CanopenSource::Hear(const ReceivedFrame& received) {
  if (IsSync(received.frame)) return HearSync(received);
  for (Encoder& encoder : encoders_) {
    const EncoderSettings& settings = encoder.settings;
    if (received.frame.id == TpdoId(settings.tpdo, settings.node) && !received.frame.extended &&
        !received.frame.remote) {
      return HearPdo(encoder, received);
    }
    if (!encoder.node.Hear(received)) continue;
    ++counts_.restarts;
    encoder.judge.LoseReference();
  }
  return Cycle::kThis;
}

CanopenSource::Cycle CanopenSource::HearSync(const ReceivedFrame& received) {
  ++counts_.syncs;
  if (produces()) {
    if (!sync_due_) {
      foreign_sync_ = true;
      return Cycle::kThis;
    }
    sync_due_ = false;
  } else if (sync_s_ || std::any_of(encoders_.begin(), encoders_.end(),
                                    [](const Encoder& e) { return e.answer; })) {
    --counts_.syncs;  // it is handled again in the next cycle
    return Cycle::kNext;
  }
  sync_heard_ = true;
  sync_s_ = received.time_s;
  return Cycle::kThis;
}

CanopenSource::Cycle CanopenSource::HearPdo(Encoder& encoder, const ReceivedFrame& received) {
  encoder.node.HearPdo();
  const bool follows_sync = produces() || sync_heard_;
  if (!follows_sync && encoder.answer) return Cycle::kNext;
  if (encoder.answer || (follows_sync && !sync_s_)) {
    ++counts_.unasked;
    encoder.owes = false;
    return Cycle::kThis;
  }
  encoder.answer = received;
  return Cycle::kThis;
}

Sample CanopenSource::SampleOf(Encoder& encoder, bool torn, double now_s) {
  const bool waited_for = encoder.node.Answers(now_s) && (sync_s_ || !produces());
  encoder.silent = !encoder.answer;
  if (encoder.silent && waited_for) ++counts_.missing;
  encoder.owes = waited_for && encoder.silent;
  const auto missing = [&](Cause cause) {
    return encoder.judge.Missing(cause, sync_s_.value_or(now_s));
  };
  if (!encoder.node.described()) return missing(Cause::kMismatch);
  if (encoder.node.in_emergency()) return missing(Cause::kSensorFault);
  if (encoder.judge.reference_lost()) return missing(Cause::kReferenceLost);
  if (encoder.silent || torn) return missing(Cause::kNoReply);
  const auto& settings = encoder.settings;
  const auto count =
      TakeBits(encoder.answer->frame, settings.at_bit, settings.bits, settings.is_signed);
  if (!count) {
    ++counts_.short_frames;
    encoder.too_short = true;
    return missing(Cause::kNoReply);
  }
  return encoder.judge.Judge(*count, sync_s_.value_or(encoder.answer->time_s), now_s);
}

std::string CanopenSource::FaultNow(double now_s) const {
  if (std::string fault = bus_->Fault(); !fault.empty()) return fault;
  if (lost_now_ > 0) {
    return fmt::format("{} frames found no room to wait: the computer is too busy for this bus",
                       lost_now_);
  }
  if (foreign_sync_)
    return "a SYNC came that abbe did not send; stop the other master or set sync_ms = 0";
  for (const Encoder& encoder : encoders_) {
    if (std::string fault = encoder.node.Fault(now_s); !fault.empty()) return fault;
    const auto say = [&](const std::string& what) {
      return fmt::format("node {} ({}) {}", encoder.settings.node, encoder.settings.name, what);
    };
    if (encoder.judge.reference_lost()) {
      return say(
          "has restarted or has another zero: its position reference is lost; bring the linkage "
          "to where its angles are known and start again");
    }
    if (encoder.too_short) {
      return say(fmt::format("sends too short a PDO: {} bytes, the value ends at bit {}",
                             encoder.answer->frame.size,
                             encoder.settings.at_bit + encoder.settings.bits));
    }
    if (encoder.silent) {
      return say(fmt::format("sent no PDO {} within {:.0f} ms", encoder.settings.tpdo,
                             1e3 * settings_.times.answer));
    }
  }
  return {};
}

void CanopenSource::Note(const std::string& fault) {
  const auto place = [&] {
    return fmt::format("device \"{}\" ({})", settings_.name, settings_.interface);
  };
  if (log_ && fault_.empty() && !fault.empty()) {
    log_(fmt::format("{}: {}; its readings are bad until it recovers", place(), fault));
  } else if (log_ && !fault_.empty() && fault.empty()) {
    log_(fmt::format("{}: has recovered", place()));
  }
  fault_ = fault;
  const bool errors = bus_->state() == CanState::kWarning || bus_->state() == CanState::kPassive;
  if (log_ && errors && !errors_) {
    log_(
        fmt::format("{}: the bus is {}: its readings are still good; check wiring, termination "
                    "and bit rate before it goes off",
                    place(), NameOf(bus_->state())));
  } else if (log_ && errors_ && bus_->state() == CanState::kActive) {
    log_(fmt::format("{}: the bus has no more errors", place()));
  }
  errors_ = errors;
}

std::string CanopenSource::Fault() const {
  return fault_.empty() ? fault_ : fmt::format("device \"{}\": {}", settings_.name, fault_);
}

}  // namespace abbe::hal
