// What the tests inside the User-Mode Linux guest share: there they are root, own vcan0 and vcan1,
// and have the programs of can-utils and iproute2 beside them. Outside of it they are skipped.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "child_process.h"
#include "hal/can/can_socket.h"
#include "hal/clock.h"

namespace abbe::hal {

class CanGuest : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("UML_GUEST") == nullptr) {
      GTEST_SKIP() << "skipped: runs inside the guest that tests/hal/uml_run makes";
    }
  }
  void TearDown() override {
    if (std::getenv("UML_GUEST") == nullptr) return;
    std::system("tc qdisc del dev vcan0 root 2>/dev/null; ip link set vcan0 up 2>/dev/null");
  }
  static void Run(const std::string& command) {
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  // Receives until a frame with this id comes; nothing within 20 s.
  std::optional<ReceivedFrame> Await(CanBus& bus, std::uint32_t id) {
    const double until = clock_.Now() + 20.0;
    while (clock_.Now() < until) {
      const auto received = bus.Receive(clock_.Now() + 0.1);
      if (received && received->frame.id == id) return received;
    }
    return {};
  }
  // Receives until the bus is in this state; false when it is not within 20 s.
  bool Reaches(CanBus& bus, CanState state) {
    const double until = clock_.Now() + 20.0;
    while (clock_.Now() < until && bus.state() != state) bus.Receive(clock_.Now() + 0.05);
    return bus.state() == state;
  }

  SteadyClock clock_;
};

}  // namespace abbe::hal
