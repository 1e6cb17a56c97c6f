#include "hal/can/encoder_judge.h"

#include <cstdlib>

namespace abbe::hal {
namespace {

constexpr int kAgreeingJumps = 3;
// What the moment of sampling may differ from its stamp.
constexpr double kStampSlack = 5e-3;
constexpr double kNoise = 2.0;  // counts

}  // namespace

bool EncoderJudge::Reachable(const Reading& from, const Reading& to) const {
  const double seconds = to.time_s - from.time_s + kStampSlack;
  return std::abs(Wrapped(encoder_, to.count - from.count)) <=
         encoder_.fastest * seconds / encoder_.Step() + kNoise;
}

bool EncoderJudge::InRange(std::int64_t count) const {
  const std::int64_t lowest = encoder_.is_signed ? -(encoder_.range / 2) : 0;
  return count >= lowest && count < lowest + encoder_.range;
}

Cause EncoderJudge::Follow(const Reading& reading) {
  if (!last_) {
    position_ = Wrapped(encoder_, reading.count - encoder_.zero);
    changed_s_ = reading.time_s;
  } else if (Reachable(*last_, reading)) {
    const std::int64_t step = Wrapped(encoder_, reading.count - last_->count);
    position_ += step;
    if (step != 0) changed_s_ = reading.time_s;
  } else {
    suspects_ = suspect_ && Reachable(*suspect_, reading) ? suspects_ + 1 : 1;
    suspect_ = reading;
    if (suspects_ >= kAgreeingJumps) reference_lost_ = true;
    return Cause::kJump;
  }
  last_ = reading;
  suspect_.reset();
  suspects_ = 0;
  return Cause::kNone;
}

Sample EncoderJudge::Judge(std::int64_t count, double time_s, double now_s) {
  if (sequence_ > 0 && time_s <= heard_s_) return Missing(Cause::kStale, now_s);
  heard_s_ = time_s;
  ++sequence_;
  if (reference_lost_) return Sample::Bad(Cause::kReferenceLost, time_s, sequence_);
  if (!InRange(count)) return Sample::Bad(Cause::kOutOfRange, time_s, sequence_);
  const Cause cause = Follow({count, time_s});
  if (cause != Cause::kNone) return Sample::Bad(cause, time_s, sequence_);
  if (now_s - time_s > stale_s_) return Sample::Bad(Cause::kStale, time_s, sequence_);
  if (!encoder_.may_freeze && time_s - changed_s_ > stale_s_) {
    return Sample::Bad(Cause::kFrozen, time_s, sequence_);
  }
  return Sample::Good(encoder_.sense * static_cast<double>(position_) * encoder_.Step(), time_s,
                      sequence_);
}

void EncoderJudge::ConfirmReference() {
  reference_lost_ = false;
  last_.reset();
  suspect_.reset();
  suspects_ = 0;
}

}  // namespace abbe::hal
