#include "hal/modbus/modbus_server.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <optional>
#include <system_error>
#include <vector>

#include "hal/modbus/modbus_frame.h"

namespace abbe::hal {
namespace {

constexpr int kStopLookMs = 20;  // how often a waiting server checks whether to stop
// A request that has begun must be complete by then.
constexpr std::chrono::milliseconds kHalfRequest{500};
constexpr int kMostRead = MODBUS_MAX_READ_REGISTERS, kMostWrite = MODBUS_MAX_WRITE_REGISTERS;

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

int Word(const std::uint8_t* bytes) { return bytes[0] << 8 | bytes[1]; }

int PortOf(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  // The port stands in the same two bytes of the IPv4 and the IPv6 address.
  return Word(reinterpret_cast<const std::uint8_t*>(&address) + 2);
}

// A parsed request.
struct Request {
  int function, address = 0, count = 1;
  std::array<std::uint16_t, kMostRead> words{};  // to be written
};

// `body` from the function on. Empty: not as long as its function wants.
std::optional<Request> TakeApart(View body) {
  Request request{body[0]};
  const std::uint8_t* data = body.data() + 1;
  if (request.function == kWhoAreYou) return request;
  if (body.size() < 5) return {};
  request.address = Word(data);
  if (request.function == kWriteOne) {
    request.words[0] = static_cast<std::uint16_t>(Word(data + 2));
  } else {
    request.count = Word(data + 2);
  }
  if (request.function != kWriteMany) return body.size() == 5 ? request : std::optional<Request>{};
  if (body.size() < 6 || body.size() != 6U + body[5] || body[5] != 2 * request.count) return {};
  for (int i = 0; i < std::min(request.count, kMostWrite); ++i) {
    request.words[i] = static_cast<std::uint16_t>(Word(data + 5 + 2 * i));
  }
  return request;
}

Answer Ask(RegisterBank& bank, int unit, Request& request) {
  const bool reads = request.function == kReadHolding || request.function == kReadInput;
  const bool writes = request.function == kWriteOne || request.function == kWriteMany;
  if (!reads && !writes) return Answer::kIllegalFunction;
  if (request.count < 1 || request.count > (reads ? kMostRead : kMostWrite)) {
    return Answer::kIllegalValue;
  }
  if (request.address + request.count > 0x10000) return Answer::kIllegalAddress;
  const std::span words(request.words.data(), request.count);
  if (writes) return bank.Write(unit, request.address, words);
  const auto table =
      request.function == kReadInput ? RegisterTable::kInput : RegisterTable::kHolding;
  return bank.Read(unit, table, request.address, words);
}

Bytes Refusal(int function, Answer answer) {
  return {static_cast<std::uint8_t>(function | 0x80), static_cast<std::uint8_t>(answer)};
}

// The basic objects: vendor, product, revision.
Bytes IdentityReply(RegisterBank& bank, int unit, View body) {
  const std::vector<std::string> objects = bank.Identity(unit);
  if (objects.empty() || body.size() != 4 || body[1] != kDeviceIdentification) {
    return Refusal(kWhoAreYou, Answer::kIllegalFunction);
  }
  Bytes reply{
      kWhoAreYou, kDeviceIdentification, 1, 1, 0, 0, static_cast<std::uint8_t>(objects.size())};
  for (std::size_t id = 0; id < objects.size(); ++id) {
    reply.push_back(static_cast<std::uint8_t>(id));
    reply.push_back(static_cast<std::uint8_t>(objects[id].size()));
    reply.insert(reply.end(), objects[id].begin(), objects[id].end());
  }
  return reply;
}

// The reply to a request, both from the function on; empty: silence.
Bytes ReplyTo(RegisterBank& bank, int unit, View body) {
  if (body[0] == kWhoAreYou) return IdentityReply(bank, unit, body);
  std::optional<Request> request = TakeApart(body);
  if (!request) return Refusal(body[0], Answer::kIllegalValue);
  const Answer answer = Ask(bank, unit, *request);
  if (answer == Answer::kSilence) return {};
  if (answer != Answer::kOk) return Refusal(body[0], answer);
  if (request->function == kWriteOne || request->function == kWriteMany) {
    return {body.begin(), body.begin() + 5};
  }
  Bytes reply{body[0], static_cast<std::uint8_t>(2 * request->count)};
  for (int i = 0; i < request->count; ++i) {
    const std::uint16_t word = request->words[i];
    reply.push_back(static_cast<std::uint8_t>(word >> 8));
    reply.push_back(static_cast<std::uint8_t>(word & 0xFF));
  }
  return reply;
}

// The length of a serial request by what came of it so far, its CRC included; more than `got` while
// bytes are missing. Empty: a function whose requests have no known length.
std::optional<std::size_t> SerialLength(View got) {
  if (got.size() < 2) return 2;
  switch (got[1]) {
    case kReadHolding:
    case kReadInput:
    case kWriteOne:
      return 8;
    case kWriteMany:
      return got.size() < 7 ? 7 : 9U + got[6];
    case kWhoAreYou:
      return 7;
    default:
      return {};
  }
}

}  // namespace

struct ModbusServer::Link {
  modbus_t* context = nullptr;
  int listener = -1;    // TCP
  int pty_client = -1;  // held open, so that the line does not hang up when a client leaves
  int unit = 1;         // serial

  explicit Link(modbus_t* new_context) : context(new_context) {
    if (context == nullptr) throw DeviceError("Modbus server: out of memory");
  }
  ~Link() {
    if (listener >= 0) close(listener);
    if (pty_client >= 0) close(pty_client);
    modbus_free(context);
  }
};

// What a client has sent and what it has not been answered yet.
struct ModbusServer::Client {
  using Clock = std::chrono::steady_clock;
  int end;
  Bytes got = {};
  Clock::time_point since = {};  // when the first byte of `got` came

  // Takes what is there; false when the client has left.
  bool Take() {
    std::array<std::uint8_t, 512> bytes{};
    const ssize_t size = read(end, bytes.data(), bytes.size());
    if (size < 0) return errno == EAGAIN || errno == EINTR;
    if (got.empty()) since = Clock::now();
    got.insert(got.end(), bytes.begin(), bytes.begin() + size);
    return size > 0;
  }
  void Drop(std::size_t count) { got.erase(got.begin(), got.begin() + count); }
  bool Stuck() const { return !got.empty() && Clock::now() - since > kHalfRequest; }
  // False when the client does not take it at once.
  bool Send(View bytes) const {
    return write(end, bytes.data(), bytes.size()) == std::ssize(bytes);
  }
};

std::vector<std::string> RegisterBank::Identity(int) { return {}; }

Answer RegisterBank::Write(int, int, std::span<const std::uint16_t>) {
  return Answer::kIllegalFunction;
}

std::unique_ptr<ModbusServer> ModbusServer::ListenTcp(const std::string& host, int port,
                                                      RegisterBank& bank) {
  auto link = std::make_unique<Link>(modbus_new_tcp_pi(host.c_str(), std::to_string(port).c_str()));
  errno = 0;
  link->listener = modbus_tcp_pi_listen(link->context, SOMAXCONN);
  if (link->listener < 0) {
    throw DeviceError(fmt::format(
        "Modbus server: cannot listen on {} port {}: {}; take another port "
        "or an address of this computer",
        host, port,
        errno != 0 ? std::generic_category().message(errno) : "the address is not known"));
  }
  const int real_port = PortOf(link->listener);
  std::unique_ptr<ModbusServer> server(new ModbusServer(std::move(link), bank));
  server->port_ = real_port;
  server->thread_ =
      std::jthread([it = server.get()](const std::stop_token& stop) { it->ServeTcp(stop); });
  return server;
}

std::unique_ptr<ModbusServer> ModbusServer::OpenSerial(const SerialLine& line, int unit,
                                                       RegisterBank& bank) {
  auto link = std::make_unique<Link>(
      modbus_new_rtu(line.device.c_str(), line.baud, line.parity, 8, line.stop_bits));
  if (modbus_set_slave(link->context, unit) != 0 || modbus_connect(link->context) != 0) {
    throw DeviceError(
        fmt::format("Modbus server: cannot open {} for unit {}: {}; check the device and "
                    "the right to use it",
                    line.device, unit, std::generic_category().message(errno)));
  }
  link->unit = unit;
  std::unique_ptr<ModbusServer> server(new ModbusServer(std::move(link), bank));
  server->device_ = line.device;
  server->thread_ =
      std::jthread([it = server.get()](const std::stop_token& stop) { it->ServeSerial(stop); });
  return server;
}

std::unique_ptr<ModbusServer> ModbusServer::OpenPty(int unit, RegisterBank& bank) {
  const int ours = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  char name[128] = "";
  if (ours < 0 || grantpt(ours) != 0 || unlockpt(ours) != 0 ||
      ptsname_r(ours, name, sizeof name) != 0) {
    if (ours >= 0) close(ours);
    throw DeviceError(fmt::format("Modbus server: no pseudo terminal: {}",
                                  std::generic_category().message(errno)));
  }
  // The name in the context is never opened: the terminal is open already.
  auto link = std::make_unique<Link>(modbus_new_rtu(name, 115200, 'N', 8, 1));
  link->listener = ours;
  link->pty_client = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios raw{};
  if (link->pty_client < 0 || tcgetattr(link->pty_client, &raw) != 0 ||
      modbus_set_slave(link->context, unit) != 0) {
    throw DeviceError(fmt::format("Modbus server: cannot serve unit {} on a pseudo terminal: {}",
                                  unit, std::generic_category().message(errno)));
  }
  cfmakeraw(&raw);
  tcsetattr(link->pty_client, TCSANOW, &raw);
  modbus_set_socket(link->context, ours);
  link->unit = unit;
  std::unique_ptr<ModbusServer> server(new ModbusServer(std::move(link), bank));
  server->device_ = name;
  server->thread_ =
      std::jthread([it = server.get()](const std::stop_token& stop) { it->ServeSerial(stop); });
  return server;
}

ModbusServer::ModbusServer(std::unique_ptr<Link> link, RegisterBank& bank)
    : link_(std::move(link)), bank_(bank) {}

ModbusServer::~ModbusServer() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void ModbusServer::ServeTcp(const std::stop_token& stop) {
  std::vector<Client> clients;
  std::vector<pollfd> ends;
  while (!stop.stop_requested()) {
    ends.assign(1, {link_->listener, POLLIN, 0});
    for (const Client& client : clients) ends.push_back({client.end, POLLIN, 0});
    poll(ends.data(), ends.size(), kStopLookMs);
    for (std::size_t i = clients.size(); i-- > 0;) {
      const bool stays = ends[i + 1].revents == 0 ? !clients[i].Stuck() : AnswerTcp(clients[i]);
      if (stays) continue;
      close(clients[i].end);
      clients.erase(clients.begin() + i);
    }
    if (ends[0].revents == 0) continue;
    int listener = link_->listener;
    const int client = modbus_tcp_pi_accept(link_->context, &listener);
    if (client < 0) continue;
    fcntl(client, F_SETFL, fcntl(client, F_GETFL) | O_NONBLOCK);
    clients.push_back({client});
  }
  for (const Client& client : clients) close(client.end);
  modbus_set_socket(link_->context, -1);
}

bool ModbusServer::AnswerTcp(Client& client) {
  if (!client.Take()) return false;
  while (client.got.size() >= kTcpHead) {
    const View got(client.got);
    const std::size_t length = Word(got.data() + 4);
    if (Word(got.data() + 2) != 0 || length < 2 || length > kLongestFrame - kTcpHead) return false;
    if (got.size() < kTcpHead + length) break;
    const Bytes body = ReplyTo(bank_, got[kTcpHead], got.subspan(kTcpHead + 1, length - 1));
    if (!body.empty()) {
      Bytes reply(got.begin(), got.begin() + kTcpHead + 1);
      reply[4] = static_cast<std::uint8_t>((body.size() + 1) >> 8);
      reply[5] = static_cast<std::uint8_t>((body.size() + 1) & 0xFF);
      reply.insert(reply.end(), body.begin(), body.end());
      ++requests_;
      if (!client.Send(reply)) return false;
    }
    client.Drop(kTcpHead + length);
  }
  return !client.Stuck();
}

void ModbusServer::ServeSerial(const std::stop_token& stop) {
  Client client{modbus_get_socket(link_->context)};
  while (!stop.stop_requested()) {
    pollfd line{client.end, POLLIN, 0};
    if (poll(&line, 1, kStopLookMs) <= 0) {
      // Silence ends a request of unknown length.
      if (!client.got.empty() && !SerialLength(client.got)) AnswerSerial(client, client.got.size());
      if (client.Stuck()) client.got.clear();
      continue;
    }
    // A line that has hung up reports it at once and for ever.
    if (!client.Take() && (line.revents & POLLHUP) != 0) poll(nullptr, 0, kStopLookMs);
    for (auto length = SerialLength(client.got); length && *length <= client.got.size();
         length = SerialLength(client.got)) {
      AnswerSerial(client, *length);
    }
  }
}

void ModbusServer::AnswerSerial(Client& client, std::size_t length) {
  const View got = View(client.got).first(length);
  const View frame = got.first(length - std::min(length, kCrcSize));
  const int crc = Crc16(frame);
  const bool whole =
      frame.size() >= 2 && got[length - 2] == (crc & 0xFF) && got[length - 1] == crc >> 8;
  if (!whole) {
    client.got.clear();
    return;
  }
  if (frame[0] == link_->unit) {
    const Bytes body = ReplyTo(bank_, frame[0], frame.subspan(1));
    if (!body.empty()) {
      Bytes reply{frame[0]};
      reply.insert(reply.end(), body.begin(), body.end());
      const std::uint16_t sum = Crc16(reply);
      reply.push_back(static_cast<std::uint8_t>(sum & 0xFF));
      reply.push_back(static_cast<std::uint8_t>(sum >> 8));
      ++requests_;
      client.Send(reply);
    }
  }
  client.Drop(length);
}

}  // namespace abbe::hal
