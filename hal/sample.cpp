#include "hal/sample.h"

#include <algorithm>

namespace abbe::hal {

std::string_view NameOf(Quality quality) {
  switch (quality) {
    case Quality::kGood:
      return "good";
    case Quality::kUncertain:
      return "uncertain";
    case Quality::kBad:
      return "bad";
  }
  return "";
}

std::string_view NameOf(Cause cause) {
  switch (cause) {
    case Cause::kNone:
      return "none";
    case Cause::kWaiting:
      return "no reading yet";
    case Cause::kStale:
      return "stale";
    case Cause::kFrozen:
      return "frozen";
    case Cause::kOutOfRange:
      return "out of range";
    case Cause::kSentinel:
      return "sentinel";
    case Cause::kSensorFault:
      return "sensor fault";
    case Cause::kNotANumber:
      return "not a number";
    case Cause::kNoReply:
      return "no reply";
    case Cause::kRefused:
      return "refused";
    case Cause::kJump:
      return "jump";
    case Cause::kReferenceLost:
      return "reference lost";
    case Cause::kMismatch:
      return "not as in the machine file";
    case Cause::kIncoherent:
      return "incoherent";
    case Cause::kInterpolated:
      return "interpolated";
    case Cause::kClockJump:
      return "clock jump";
  }
  return "";
}

bool SampleSet::AllGood() const {
  return std::all_of(samples.begin(), samples.end(), [](const Sample& s) { return s.good(); });
}

}  // namespace abbe::hal
