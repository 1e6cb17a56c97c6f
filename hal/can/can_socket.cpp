#include "hal/can/can_socket.h"

#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>

namespace abbe::hal {
namespace {

constexpr double kLookAgain = 0.05;  // s of real time, between two checks for a lost interface

template <class Value>
void Set(int socket, int level, int option, const Value& value) {
  setsockopt(socket, level, option, &value, sizeof(value));
}

double RealTimeNow() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

can_frame ToWire(const CanFrame& frame) {
  can_frame wire{};
  wire.can_id =
      frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
  wire.can_dlc = frame.size;
  std::copy(frame.data.begin(), frame.data.end(), wire.data);
  return wire;
}

CanFrame FromWire(const can_frame& wire) {
  CanFrame frame;
  frame.extended = (wire.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (wire.can_id & CAN_RTR_FLAG) != 0;
  frame.id = wire.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = std::min<std::uint8_t>(wire.can_dlc, CAN_MAX_DLEN);
  if (!frame.remote) std::copy_n(wire.data, frame.size, frame.data.begin());
  return frame;
}

constexpr std::size_t kBatch = 8;  // frames fetched by one system call

}  // namespace

// A frame as recvmmsg() returns it.
struct CanSocket::MessageBuffer {
  can_frame wire;
  iovec part;
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))];
  msghdr header;
  std::size_t size;
};

struct CanSocket::Batch {
  std::array<MessageBuffer, kBatch> buffers;
  double calendar_s, clock_s;  // when they were fetched
};

CanSocket::CanSocket(std::string interface, Clock& clock, std::vector<std::uint32_t> only,
                     int buffer)
    : interface_(std::move(interface)),
      clock_(clock),
      only_(std::move(only)),
      buffer_(buffer),
      last_s_(clock.Now()),
      batch_(std::make_unique<Batch>()) {
  Open();
}

CanSocket::~CanSocket() { Close(); }

void CanSocket::Close() {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
  next_ = fetched_ = 0;
}

void CanSocket::Open() {
  looked_s_ = clock_.Now();
  socket_ = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
  if (socket_ < 0) {
    state_ = CanState::kGone;
    reason_ = fmt::format("this computer's kernel has no CAN ({})", std::strerror(errno));
    return;
  }
  Set(socket_, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, 1);
  Set(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, can_err_mask_t{CAN_ERR_MASK});
  if (!only_.empty()) {
    std::vector<can_filter> filters;
    for (const std::uint32_t id : only_) {
      filters.push_back({id, CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG});
    }
    setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
               static_cast<socklen_t>(filters.size() * sizeof(can_filter)));
  }
  Set(socket_, SOL_SOCKET, SO_TIMESTAMPNS, 1);
  Set(socket_, SOL_SOCKET, SO_RXQ_OVFL, 1);
  Set(socket_, SOL_SOCKET, SO_RCVBUF, buffer_);
  Set(socket_, SOL_SOCKET, SO_RCVBUFFORCE, buffer_);
  overflow_ = 0;
  drained_ = false;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface_.c_str()));
  if (address.can_ifindex == 0 ||
      bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    Fail(ENODEV);
    reason_ = "there is no such CAN interface";
    return;
  }
  reason_.clear();
  state_ = InterfaceUp() ? CanState::kActive : CanState::kDown;
}

bool CanSocket::InterfaceUp() const {
  ifreq request{};
  interface_.copy(request.ifr_name, IFNAMSIZ - 1);
  return ioctl(socket_, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

void CanSocket::Fail(int error) {
  if (error == ENETDOWN) {
    state_ = state_ == CanState::kBusOff && InterfaceUp() ? CanState::kBusOff : CanState::kDown;
  } else if (error == ENODEV || error == ENXIO) {
    Close();
    state_ = CanState::kGone;
  }
}

void CanSocket::Recover() {
  const double now = clock_.Now();
  if (now - looked_s_ < kLookAgain * clock_.speed()) return;
  looked_s_ = now;
  if (socket_ < 0) return Open();
  if (state_ == CanState::kDown && InterfaceUp()) state_ = CanState::kActive;
}

bool CanSocket::Send(const CanFrame& frame) {
  if (!Works(state_)) Recover();
  if (!Works(state_)) return false;
  const can_frame wire = ToWire(frame);
  if (write(socket_, &wire, sizeof(wire)) == static_cast<ssize_t>(sizeof(wire))) return true;
  Fail(errno);
  return false;
}

std::optional<ReceivedFrame> CanSocket::Receive(double until_s) {
  if (!Works(state_)) Recover();
  while (true) {
    while (next_ < fetched_) {
      ReceivedFrame received;
      if (Understand(batch_->buffers[next_++], received)) return received;
    }
    if (socket_ < 0) return {};
    const bool in_time = !drained_ || !Works(state_) || Wait(until_s);
    Fetch();
    if (fetched_ == 0 && (!in_time || !Works(state_))) return {};
  }
}

bool CanSocket::Wait(double until_s) {
  if (until_s <= last_s_) return false;
  const double left = (until_s - clock_.Now()) / clock_.speed();
  if (left <= 0.0) return false;
  timespec span{};
  span.tv_sec = static_cast<time_t>(left);
  span.tv_nsec = static_cast<long>(1e9 * (left - std::floor(left)));
  pollfd wanted{socket_, POLLIN, 0};
  ppoll(&wanted, 1, &span, nullptr);
  return true;
}

void CanSocket::Fetch() {
  std::array<mmsghdr, kBatch> messages{};
  for (std::size_t i = 0; i < kBatch; ++i) {
    MessageBuffer& buffer = batch_->buffers[i];
    buffer.part = {&buffer.wire, sizeof(buffer.wire)};
    messages[i].msg_hdr.msg_iov = &buffer.part;
    messages[i].msg_hdr.msg_iovlen = 1;
    messages[i].msg_hdr.msg_control = buffer.control;
    messages[i].msg_hdr.msg_controllen = sizeof(buffer.control);
  }
  const int count = recvmmsg(socket_, messages.data(), kBatch, 0, nullptr);
  next_ = 0;
  fetched_ = count < 0 ? 0 : static_cast<std::size_t>(count);
  drained_ = fetched_ < kBatch;
  if (count < 0 && errno != EAGAIN && errno != EINTR) return Fail(errno);
  if (fetched_ == 0) return;
  for (std::size_t i = 0; i < fetched_; ++i) {
    batch_->buffers[i].header = messages[i].msg_hdr;
    batch_->buffers[i].size = messages[i].msg_len;
  }
  batch_->calendar_s = RealTimeNow();
  batch_->clock_s = clock_.Now();
}

bool CanSocket::Understand(MessageBuffer& buffer, ReceivedFrame& received) {
  const can_frame& wire = buffer.wire;
  if (buffer.size != sizeof(wire)) return false;
  double age_s = 0.0;
  for (cmsghdr* at = CMSG_FIRSTHDR(&buffer.header); at != nullptr;
       at = CMSG_NXTHDR(&buffer.header, at)) {
    if (at->cmsg_level != SOL_SOCKET) continue;
    if (at->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(at), sizeof(stamp));
      age_s = batch_->calendar_s - stamp.tv_sec - 1e-9 * stamp.tv_nsec;
    } else if (at->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t overflow = 0;
      std::memcpy(&overflow, CMSG_DATA(at), sizeof(overflow));
      lost_ += overflow - overflow_;  // modulo 2^32, as the kernel counts
      overflow_ = overflow;
    }
  }
  if ((wire.can_id & CAN_ERR_FLAG) != 0) {
    HearErrorFrame(wire.can_id, wire.data);
    return false;
  }
  if (state_ == CanState::kBusOff) state_ = CanState::kActive;
  received = {FromWire(wire), TimeOf(age_s), (buffer.header.msg_flags & MSG_CONFIRM) != 0};
  return true;
}

// Clamped to what is possible, because the computer's calendar may have been set meanwhile.
double CanSocket::TimeOf(double age_s) {
  const double now = batch_->clock_s;
  last_s_ = std::clamp(now - age_s * clock_.speed(), std::min(last_s_, now), now);
  return last_s_;
}

void CanSocket::HearErrorFrame(std::uint32_t id, const std::uint8_t* data) {
  ++errors_;
  if ((id & CAN_ERR_CRTL) != 0) {
    const int controller = data[1];
    if ((controller & CAN_ERR_CRTL_RX_OVERFLOW) != 0) ++lost_;
    if ((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      state_ = CanState::kPassive;
    } else if ((controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      state_ = CanState::kWarning;
    } else if ((controller & CAN_ERR_CRTL_ACTIVE) != 0) {
      state_ = CanState::kActive;
    }
  }
  if ((id & CAN_ERR_RESTARTED) != 0) state_ = CanState::kActive;
  if ((id & CAN_ERR_BUSOFF) != 0) state_ = CanState::kBusOff;
}

std::string CanSocket::Fault() const {
  switch (state_) {
    case CanState::kActive:
    case CanState::kWarning:
    case CanState::kPassive:
      return {};
    case CanState::kBusOff:
      return fmt::format(
          "{}: bus-off: check the bit rate, the wiring and the termination, then restart it with "
          "`ip link set {} type can restart`",
          interface_, interface_);
    case CanState::kDown:
      return fmt::format("{}: is down: switch it on with `ip link set {} up`", interface_,
                         interface_);
    case CanState::kGone:
      return fmt::format("{}: {}", interface_,
                         reason_.empty() ? "the CAN interface was removed" : reason_);
  }
  return {};
}

}  // namespace abbe::hal
