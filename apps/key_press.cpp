#include "apps/key_press.h"

#include <poll.h>
#include <unistd.h>

#include "apps/interrupt.h"

namespace abbe::apps {

hal::Confirmation KeyPress::Poll() {
  using hal::Confirmation;
  if (InterruptFlag() || ended_) return Confirmation::kEnd;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (poll(&input, 1, 0) > 0) {
    char byte = 0;
    if (read(STDIN_FILENO, &byte, 1) != 1) {
      ended_ = true;
      return Confirmation::kEnd;
    }
    if (byte == '\n') return Confirmation::kStands;
  }
  return Confirmation::kNotYet;
}

}  // namespace abbe::apps
