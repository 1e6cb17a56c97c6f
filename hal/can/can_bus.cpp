#include "hal/can/can_bus.h"

namespace abbe::hal {

std::string_view NameOf(CanState state) {
  switch (state) {
    case CanState::kActive:
      return "active";
    case CanState::kWarning:
      return "error warning";
    case CanState::kPassive:
      return "error passive";
    case CanState::kBusOff:
      return "bus-off";
    case CanState::kDown:
      return "down";
    case CanState::kGone:
      return "gone";
  }
  return "";
}

}  // namespace abbe::hal
