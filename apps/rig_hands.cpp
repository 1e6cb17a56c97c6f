#include "apps/rig_hands.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <sstream>

#include "failure/failure.h"
#include "settings/unit.h"

namespace abbe::apps {

void DoByHand(const std::string& line, rig::LiveMachine& machine) {
  std::istringstream words(line);
  std::string verb, what;
  double amount = 0.0;
  words >> verb >> what;
  const bool has_amount = static_cast<bool>(words >> amount);
  const bool is_axis = what.size() == 1;
  if (verb == "move" && is_axis && has_amount) {
    machine.Jog(rig::AxisNumber(what.front()), amount * settings::kMillimetre);
  } else if (verb == "turn" && has_amount) {
    machine.Turn(what, amount);
  } else if (verb == "head" && is_axis) {
    machine.InstallHead(rig::AxisNumber(what.front()));
  } else {
    throw InputError(fmt::format(
        "\"{}\": hands do \"move X 60\" (mm), \"turn SCREW -0.35\" (turns) or \"head Y\"", line));
  }
}

void RigHands::Poll(rig::LiveMachine& machine) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!ended_ && poll(&input, 1, 0) > 0) {
    char byte = 0;
    if (read(STDIN_FILENO, &byte, 1) != 1) {
      ended_ = true;
    } else if (byte != '\n') {
      line_ += byte;
    } else {
      try {
        DoByHand(line_, machine);
      } catch (const InputError& refused) {
        fmt::print(stderr, "abbe: {}\n", refused.what());
      }
      line_.clear();
    }
  }
}

}  // namespace abbe::apps
