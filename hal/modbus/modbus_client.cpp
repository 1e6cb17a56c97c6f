#include "hal/modbus/modbus_client.h"

#include <fmt/format.h>
#include <modbus/modbus.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <thread>

namespace abbe::hal {
namespace {

// s: a wait that ends so much later than it should is that of a program that did not run.
constexpr double kAway = 0.1;

std::string ErrorText(int error) { return std::generic_category().message(error); }

ModbusClient::Time After(ModbusClient::Time start, double seconds) {
  return start +
         std::chrono::duration_cast<BootClock::duration>(std::chrono::duration<double>(seconds));
}

double SecondsTo(ModbusClient::Time time) {
  return std::chrono::duration<double>(time - BootClock::now()).count();
}

int MillisecondsTo(ModbusClient::Time time) {
  return std::max(0, static_cast<int>(std::ceil(1e3 * SecondsTo(time))));
}

std::string NumericHost(const ModbusSettings& device) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(device.host.c_str(), nullptr, &hints, &found);
  char text[NI_MAXHOST] = "";
  if (error == 0) {
    getnameinfo(found->ai_addr, found->ai_addrlen, text, sizeof text, nullptr, 0, NI_NUMERICHOST);
    freeaddrinfo(found);
  }
  if (text[0] != '\0') return text;
  throw DeviceError(
      fmt::format("device \"{}\": the host \"{}\" cannot be found ({}); check the name "
                  "or write the numeric address",
                  device.name, device.host, gai_strerror(error)));
}

modbus_t* NewContext(const ModbusSettings& device) {
  if (device.framing == ModbusFraming::kTcp) {
    return modbus_new_tcp_pi(NumericHost(device).c_str(), std::to_string(device.port).c_str());
  }
  const SerialLine& line = device.serial;
  return modbus_new_rtu(line.device.c_str(), line.baud, line.parity, 8, line.stop_bits);
}

}  // namespace

struct ModbusClient::Link {
  modbus_t* context;

  explicit Link(const ModbusSettings& device) : context(NewContext(device)) {
    if (context == nullptr || modbus_set_slave(context, device.unit) != 0) {
      throw DeviceError(
          fmt::format("device \"{}\": {} is not a Modbus link: {}; check its settings", device.name,
                      PlaceOf(device), ErrorText(errno)));
    }
  }
  ~Link() {
    modbus_close(context);
    modbus_free(context);
  }
  int socket() const { return modbus_get_socket(context); }
};

ModbusClient::ModbusClient(const ModbusSettings& device)
    : device_(device), link_(std::make_unique<Link>(device)) {}

ModbusClient::~ModbusClient() = default;

ModbusClient::Time ModbusClient::Deadline() const {
  return After(BootClock::now(), device_.times.deadline);
}

std::optional<ModbusFault> ModbusClient::Read(RegisterTable table, int address,
                                              std::span<std::uint16_t> words, Time deadline) {
  const ModbusRequest request{device_.unit, table == RegisterTable::kInput ? 4 : 3, address,
                              static_cast<int>(words.size())};
  Fault fault = Exchange(request, deadline);
  if (fault) return fault;
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = static_cast<std::uint16_t>(words_[2 * i] << 8 | words_[2 * i + 1]);
  }
  return {};
}

std::optional<ModbusFault> ModbusClient::Write(int address, std::uint16_t word, Time deadline) {
  return Exchange({device_.unit, 6, address, word}, deadline);
}

std::string ModbusClient::Identity(Time deadline) {
  if (!Exchange({device_.unit, kWhoAreYou, 0, 0}, deadline)) return IdentityText(objects_);
  if (!connected_) std::this_thread::sleep_until(std::min(retry_at_, deadline));
  return {};
}

ModbusClient::Fault ModbusClient::Exchange(const ModbusRequest& request, Time deadline) {
  if (!connected_) {
    if (Fault fault = Connect(deadline)) return fault;
  }
  WaitForSilence(deadline);
  modbus_flush(link_->context);
  ++transaction_;
  if (Fault fault = Send(Encode(request, device_.framing, transaction_).view(), request))
    return fault;
  if (Fault fault = Receive(request, deadline)) return fault;
  quiet_since_ = BootClock::now();
  const ModbusReply reply =
      CheckReply(request, device_.framing, transaction_, std::span(reply_.data(), reply_size_));
  if (!reply.wrong.empty()) {
    return Drop(ModbusFault::Kind::kBadReply,
                fmt::format("{} to: {}", reply.wrong, request.Text()));
  }
  backoff_s_ = 0.0;
  if (reply.exception != 0) {
    return ModbusFault{ModbusFault::Kind::kException, reply.exception,
                       fmt::format("{} to: {}", ExceptionText(reply.exception), request.Text())};
  }
  words_ = reply.words;
  objects_ = reply.objects;
  return {};
}

ModbusClient::Fault ModbusClient::Connect(Time deadline) {
  const auto now = BootClock::now();
  if (now < retry_at_) return ModbusFault{ModbusFault::Kind::kNoLink, 0, last_fault_};
  const double limit =
      std::clamp(std::min(device_.times.response, SecondsTo(deadline)), 1e-3, 60.0);
  const auto whole = static_cast<std::uint32_t>(limit);
  modbus_set_response_timeout(link_->context, whole,
                              static_cast<std::uint32_t>(1e6 * (limit - whole)));
  if (modbus_connect(link_->context) != 0) {
    const int error = errno;
    return Drop(ModbusFault::Kind::kNoLink, fmt::format("cannot connect: {}", ErrorText(error)));
  }
  connected_ = true;
  ++connections_;
  return {};
}

ModbusClient::Fault ModbusClient::Send(std::span<const std::uint8_t> frame,
                                       const ModbusRequest& request) {
  const bool tcp = device_.framing == ModbusFraming::kTcp;
  const ssize_t sent = tcp ? send(link_->socket(), frame.data(), frame.size(), MSG_NOSIGNAL)
                           : write(link_->socket(), frame.data(), frame.size());
  if (sent == std::ssize(frame)) return {};
  const int error = sent < 0 ? errno : EIO;
  return Drop(ModbusFault::Kind::kNoLink,
              fmt::format("the link broke ({}) at: {}", ErrorText(error), request.Text()));
}

ModbusClient::Fault ModbusClient::Receive(const ModbusRequest& request, Time deadline) {
  const auto start = BootClock::now();
  Time limit = std::min(After(start, device_.times.response), deadline);
  pollfd end{link_->socket(), POLLIN, 0};
  reply_size_ = 0;
  const auto got = [&] { return std::span<const std::uint8_t>(reply_.data(), reply_size_); };
  std::size_t wanted = ReplyLength(got(), device_.framing);
  while (reply_size_ < wanted) {
    const int ready = poll(&end, 1, MillisecondsTo(limit));
    if (ready < 0 && errno == EINTR) continue;
    const double over = -SecondsTo(limit), waited_ms = -1e3 * SecondsTo(start);
    if (over > kAway) {
      // The time of arrival of what has been received meanwhile is not known.
      return Drop(ModbusFault::Kind::kSuspended,
                  fmt::format("abbe did not run for {:.0f} ms (suspended, or the computer is too "
                              "busy) while it waited for the answer to: {}",
                              1e3 * over, request.Text()));
    }
    if (ready <= 0 || over > 0.0) {
      return Drop(ModbusFault::Kind::kTimeout,
                  reply_size_ == 0
                      ? fmt::format("no answer within {:.0f} ms to: {}", waited_ms, request.Text())
                      : fmt::format("only {} of {} bytes within {:.0f} ms to: {}", reply_size_,
                                    wanted, waited_ms, request.Text()));
    }
    const ssize_t size =
        read(link_->socket(), reply_.data() + reply_size_, reply_.size() - reply_size_);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) {
      const std::string why = size == 0 ? "closed by the device" : ErrorText(errno);
      return Drop(ModbusFault::Kind::kNoLink,
                  fmt::format("the link broke ({}) at: {}", why, request.Text()));
    }
    reply_size_ += size;
    wanted = ReplyLength(got(), device_.framing);
    limit = std::min(After(BootClock::now(), device_.times.byte), deadline);
  }
  reply_size_ = wanted;  // what follows a complete reply is not part of it
  return {};
}

ModbusClient::Fault ModbusClient::Drop(ModbusFault::Kind kind, std::string text) {
  modbus_close(link_->context);
  connected_ = false;
  const auto now = BootClock::now();
  // Serial replies carry no number: one that is still under way must have died out before the next
  // request, or it would be taken for the answer to it.
  const bool tcp = device_.framing == ModbusFraming::kTcp;
  retry_at_ = After(now, std::max(backoff_s_, tcp ? 0.0 : device_.times.response));
  backoff_s_ =
      std::clamp(2.0 * backoff_s_, device_.times.backoff_first, device_.times.backoff_most);
  last_fault_ = text;
  return ModbusFault{kind, 0, std::move(text)};
}

void ModbusClient::WaitForSilence(Time deadline) const {
  if (device_.times.wait <= 0.0) return;
  std::this_thread::sleep_until(std::min(After(quiet_since_, device_.times.wait), deadline));
}

}  // namespace abbe::hal
