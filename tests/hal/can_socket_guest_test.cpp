// SocketCAN in a guest, against can-utils, iproute2 and the kernel's own drivers.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <ctime>
#include <thread>
#include <vector>

#include "can_guest.h"

namespace abbe::hal {
namespace can_socket_guest_test {

class CanSocketGuest : public CanGuest {};

TEST_F(CanSocketGuest, HearsWhatCansendSends) {
  CanSocket bus("vcan0", clock_);
  EXPECT_EQ(bus.Fault(), "");
  CanSocket other("vcan1", clock_);
  const double before = clock_.Now();
  Run("cansend vcan0 181#DEADBEEF01 && cansend vcan0 12345678#01 && cansend vcan0 182#R");
  const auto pdo = Await(bus, 0x181);
  ASSERT_TRUE(pdo.has_value());
  EXPECT_EQ(pdo->frame.size, 5);
  EXPECT_EQ(pdo->frame.data[0], 0xDE);
  EXPECT_EQ(pdo->frame.data[4], 0x01);
  EXPECT_FALSE(pdo->own);
  const auto extended = bus.Receive(clock_.Now() + 5.0);
  ASSERT_TRUE(extended.has_value());
  EXPECT_EQ(extended->frame.id, 0x12345678u);
  EXPECT_TRUE(extended->frame.extended);
  const auto remote = bus.Receive(clock_.Now() + 5.0);
  ASSERT_TRUE(remote.has_value());
  EXPECT_TRUE(remote->frame.remote);
  EXPECT_GE(pdo->time_s, before);
  EXPECT_GE(extended->time_s, pdo->time_s);
  EXPECT_GE(remote->time_s, extended->time_s);
  EXPECT_LE(remote->time_s, clock_.Now());
  EXPECT_FALSE(other.Receive(clock_.Now()).has_value());
}

// The stamp is that of the passage, however late it is fetched.
TEST_F(CanSocketGuest, LeavesOtherIdentifiersToTheKernel) {
  CanSocket bus("vcan0", clock_, {0x080, 0x602});
  Run("cansend vcan0 181#00; cansend vcan0 00000080#00; cansend vcan0 602#01; cansend vcan0 080#");
  const auto first = Await(bus, 0x602);
  ASSERT_TRUE(first);
  const auto second = bus.Receive(clock_.Now() + 5.0);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->frame.id, 0x080u);
  EXPECT_FALSE(second->frame.extended);
}

TEST_F(CanSocketGuest, StampsAreOfThePassageNotOfTheFetching) {
  CanSocket bus("vcan0", clock_);
  const double before = clock_.Now();
  Run("cansend vcan0 181#00");
  const double sent = clock_.Now();
  clock_.SleepUntil(sent + 0.3);
  const auto pdo = Await(bus, 0x181);
  ASSERT_TRUE(pdo.has_value());
  EXPECT_GE(pdo->time_s, before);
  EXPECT_LE(pdo->time_s, sent);
}

TEST_F(CanSocketGuest, CandumpSeesWhatItSends) {
  ChildProcess candump({"candump", "-L", "-n", "3", "vcan0"});
  CanSocket bus("vcan0", clock_);
  clock_.SleepUntil(clock_.Now() + 1.0);  // candump opens its socket
  CanFrame frame{.id = 0x601, .size = 8};
  frame.data = {0x40, 0x01, 0x60};
  ASSERT_TRUE(bus.Send(frame));
  ASSERT_TRUE(bus.Send({.id = 0x1ABCDEF0, .extended = true, .size = 1, .data = {7}}));
  ASSERT_TRUE(bus.Send({.id = 0x181, .remote = true}));
  const auto text = [&] {
    const std::string line = candump.Line();
    return line.substr(line.find("vcan0"));
  };
  EXPECT_EQ(text(), "vcan0 601#4001600000000000");
  EXPECT_EQ(text(), "vcan0 1ABCDEF0#07");
  EXPECT_EQ(text(), "vcan0 181#R");
  const auto own = bus.Receive(clock_.Now());
  ASSERT_TRUE(own.has_value());
  EXPECT_TRUE(own->own);
  EXPECT_EQ(own->frame, frame);
}

TEST_F(CanSocketGuest, ReturnsAtItsDeadline) {
  CanSocket bus("vcan0", clock_);
  const double until = clock_.Now() + 0.2;
  EXPECT_FALSE(bus.Receive(until).has_value());
  EXPECT_GE(clock_.Now(), until);
  EXPECT_FALSE(bus.Receive(0.0).has_value());
}

// The kernel keeps the oldest frames and tells the number of the lost ones with the next frame.
TEST_F(CanSocketGuest, CountsWhatTheQueueHadNoRoomFor) {
  CanSocket bus("vcan0", clock_, {}, 1);
  Run("cangen vcan0 -g 0 -n 2000 -I 123 -L 8 -D i");
  std::uint64_t heard = 0;
  while (bus.Receive(clock_.Now())) ++heard;
  EXPECT_LT(heard, 2000u);
  Run("cansend vcan0 321#");
  ASSERT_TRUE(Await(bus, 0x321).has_value());
  EXPECT_EQ(heard + bus.lost(), 2000u);
}

TEST_F(CanSocketGuest, SaysThatTheInterfaceIsDownAndComesBackWithIt) {
  CanSocket bus("vcan0", clock_);
  Run("ip link set vcan0 down");
  EXPECT_TRUE(Reaches(bus, CanState::kDown));
  EXPECT_EQ(bus.Fault(), "vcan0: is down: switch it on with `ip link set vcan0 up`");
  EXPECT_FALSE(bus.Send({.id = 1}));
  CanSocket opened_meanwhile("vcan0", clock_);
  EXPECT_EQ(opened_meanwhile.state(), CanState::kDown);
  Run("ip link set vcan0 up");
  EXPECT_TRUE(Reaches(bus, CanState::kActive));
  EXPECT_TRUE(Reaches(opened_meanwhile, CanState::kActive));
  ASSERT_TRUE(bus.Send({.id = 0x77}));
  EXPECT_TRUE(Await(opened_meanwhile, 0x77).has_value());
}

TEST_F(CanSocketGuest, SurvivesThatTheInterfaceIsRemovedAndMadeAgain) {
  Run("ip link add dev vcan7 type vcan && ip link set vcan7 up");
  CanSocket bus("vcan7", clock_);
  EXPECT_EQ(bus.state(), CanState::kActive);
  Run("ip link delete vcan7");
  EXPECT_TRUE(Reaches(bus, CanState::kGone));
  EXPECT_NE(bus.Fault().find("vcan7: "), std::string::npos);
  Run("ip link add dev vcan7 type vcan && ip link set vcan7 up");
  EXPECT_TRUE(Reaches(bus, CanState::kActive));
  Run("cansend vcan7 123#42");
  EXPECT_TRUE(Await(bus, 0x123).has_value());
  Run("ip link delete vcan7");
}

TEST_F(CanSocketGuest, AnInterfaceThatIsNotThereIsNamed) {
  CanSocket bus("can9", clock_);
  EXPECT_EQ(bus.state(), CanState::kGone);
  EXPECT_EQ(bus.Fault(), "can9: there is no such CAN interface");
  CanSocket not_can("lo", clock_);
  EXPECT_EQ(not_can.Fault(), "lo: there is no such CAN interface");
}

TEST_F(CanSocketGuest, ErrorFramesSetTheState) {
  CanSocket bus("vcan0", clock_);
  Run("cansend vcan0 20000004#0008000000000000");
  EXPECT_TRUE(Reaches(bus, CanState::kWarning));
  Run("cansend vcan0 20000004#0030000000008585");
  EXPECT_TRUE(Reaches(bus, CanState::kPassive));
  EXPECT_EQ(bus.Fault(), "");
  Run("cansend vcan0 20000040#0000000000000000");
  EXPECT_TRUE(Reaches(bus, CanState::kBusOff));
  EXPECT_NE(bus.Fault().find("vcan0: bus-off"), std::string::npos);
  EXPECT_FALSE(bus.Send({.id = 1}));
  Run("cansend vcan0 20000100#0000000000000000");
  EXPECT_TRUE(Reaches(bus, CanState::kActive));
  EXPECT_EQ(bus.errors(), 4u);
}

// A real controller's states: the kernel's slcan driver on a pseudo terminal, whose far end is the
// controller.
TEST_F(CanSocketGuest, FollowsAControllerThroughBusOffAndBack) {
  constexpr int kSlcanDiscipline = 17;
  const int far = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(far, 0);
  ASSERT_EQ(grantpt(far), 0);
  ASSERT_EQ(unlockpt(far), 0);
  const int near = open(ptsname(far), O_RDWR | O_NOCTTY);
  ASSERT_GE(near, 0);
  Run(std::string("stty -F ") + ptsname(far) + " raw -echo");
  ASSERT_EQ(ioctl(near, TIOCSETD, &kSlcanDiscipline), 0);
  fcntl(far, F_SETFL, O_NONBLOCK);
  std::atomic<bool> done{false};
  std::thread reader([&] {  // what the driver says must be read
    char bytes[256];
    while (!done) {
      if (read(far, bytes, sizeof(bytes)) <= 0) usleep(1000);
    }
  });
  std::system(
      "ip link set $(ip -o link | grep -o 's*l*can[0-9]*:' | grep -v vcan | tr -d : | head -1) "
      "name real0");
  Run("ip link set real0 type can bitrate 500000 && ip link set real0 up");
  CanSocket bus("real0", clock_);
  const auto say = [&](const std::string& line) {
    ASSERT_EQ(write(far, line.data(), line.size()), static_cast<ssize_t>(line.size()));
  };
  say("t1812AABB\r");
  EXPECT_TRUE(Await(bus, 0x181).has_value());
  say("sw100096\r");
  EXPECT_TRUE(Reaches(bus, CanState::kWarning));
  say("sp128130\r");
  EXPECT_TRUE(Reaches(bus, CanState::kPassive));
  say("sb000256\r");
  EXPECT_TRUE(Reaches(bus, CanState::kBusOff));
  say("sa000000\r");
  EXPECT_TRUE(Reaches(bus, CanState::kActive));
  say("t1812CCDD\r");
  EXPECT_TRUE(Await(bus, 0x181).has_value());
  done = true;
  reader.join();
  close(near);
  close(far);
  EXPECT_TRUE(Reaches(bus, CanState::kGone));
}

// The kernel's stamps are of the calendar, which somebody may set: an hour on, and back.
TEST_F(CanSocketGuest, StampsStayWithinWhatIsPossibleWhenTheCalendarIsSet) {
  CanSocket bus("vcan0", clock_);
  double last = 0.0;
  for (const double step_s : {3600.0, -3600.0, -7200.0, 7200.0}) {
    const double before = clock_.Now();
    Run("cansend vcan0 181#00");
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    now.tv_sec += static_cast<time_t>(step_s);
    ASSERT_EQ(clock_settime(CLOCK_REALTIME, &now), 0);
    EXPECT_LT(clock_.Now() - before, 60.0);  // the clock of the measurement does not heed it
    const auto pdo = Await(bus, 0x181);
    ASSERT_TRUE(pdo.has_value());
    EXPECT_GE(pdo->time_s, last);
    EXPECT_LE(pdo->time_s, clock_.Now());
    last = pdo->time_s;
    // Nor do deadlines.
    EXPECT_FALSE(bus.Receive(clock_.Now() + 0.2).has_value());
    EXPECT_LT(clock_.Now() - before, 60.0);
  }
}

}  // namespace can_socket_guest_test
}  // namespace abbe::hal
