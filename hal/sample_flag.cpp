#include "hal/sample_flag.h"

#include "recording/recording.h"

namespace abbe::hal {

std::uint32_t FlagOf(Cause cause) {
  switch (cause) {
    case Cause::kNone:
      return 0;
    case Cause::kWaiting:
    case Cause::kStale:
    case Cause::kFrozen:
      return recording::kStale;
    case Cause::kOutOfRange:
    case Cause::kSentinel:
    case Cause::kJump:
      return recording::kOutOfRange;
    case Cause::kSensorFault:
    case Cause::kNotANumber:
    case Cause::kNoReply:
    case Cause::kRefused:
    case Cause::kReferenceLost:
    case Cause::kMismatch:
    case Cause::kIncoherent:
      return recording::kDeviceError;
    case Cause::kInterpolated:
      return recording::kInterpolated;
    case Cause::kClockJump:
      return recording::kClockJump;
  }
  return recording::kDeviceError;
}

Cause CauseOf(std::uint32_t flags) {
  if ((flags & recording::kDeviceError) != 0) return Cause::kNoReply;
  if ((flags & recording::kOutOfRange) != 0) return Cause::kOutOfRange;
  if ((flags & recording::kStale) != 0) return Cause::kStale;
  if ((flags & recording::kClockJump) != 0) return Cause::kClockJump;
  if ((flags & recording::kInterpolated) != 0) return Cause::kInterpolated;
  return flags == 0 ? Cause::kNone : Cause::kNoReply;
}

}  // namespace abbe::hal
