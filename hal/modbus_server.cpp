#include "hal/modbus_server.h"

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
#include <system_error>
#include <vector>

#include "hal/modbus_frame.h"

namespace abbe::hal {
namespace {

constexpr int kStopLookMs = 20;          // how often a waiting server looks whether to stop
constexpr int kHalfRequestUs = 500'000;  // a request that has begun must be complete by then
constexpr int kMostRead = MODBUS_MAX_READ_REGISTERS, kMostWrite = MODBUS_MAX_WRITE_REGISTERS;

std::string ErrorText(int error) { return std::generic_category().message(error); }

int Word(const std::uint8_t* bytes) { return bytes[0] << 8 | bytes[1]; }

int PortOf(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  // The port stands in the same two bytes of the IPv4 and the IPv6 address.
  return Word(reinterpret_cast<const std::uint8_t*>(&address) + 2);
}

// What a request asks for, taken apart once.
struct Request {
  int unit, function, address = 0, count = 1;
  std::array<std::uint16_t, kMostRead> words{};  // to be written
};

Request TakeApart(const std::uint8_t* bytes, int header) {
  Request request{bytes[header - 1], bytes[header]};
  const std::uint8_t* data = bytes + header + 1;
  request.address = Word(data);
  if (request.function == kWriteOne) {
    request.words[0] = static_cast<std::uint16_t>(Word(data + 2));
  } else {
    request.count = Word(data + 2);
  }
  if (request.function == kWriteMany) {
    for (int i = 0; i < std::min(request.count, kMostWrite); ++i) {
      request.words[i] = static_cast<std::uint16_t>(Word(data + 5 + 2 * i));
    }
  }
  return request;
}

Answer Ask(RegisterBank& bank, Request& request) {
  const bool reads = request.function == kReadHolding || request.function == kReadInput;
  const bool writes = request.function == kWriteOne || request.function == kWriteMany;
  if (!reads && !writes) return Answer::kIllegalFunction;
  if (request.count < 1 || request.count > (reads ? kMostRead : kMostWrite)) {
    return Answer::kIllegalValue;
  }
  if (request.address + request.count > 0x10000) return Answer::kIllegalAddress;
  const std::span words(request.words.data(), static_cast<std::size_t>(request.count));
  if (writes) return bank.Write(request.unit, request.address, words);
  const auto table =
      request.function == kReadInput ? RegisterTable::kInput : RegisterTable::kHolding;
  return bank.Read(request.unit, table, request.address, words);
}

}  // namespace

struct ModbusServer::Link {
  modbus_t* context = nullptr;
  int listener = -1;    // TCP
  int pty_client = -1;  // held open, so that the line does not hang up when a client leaves

  explicit Link(modbus_t* new_context) : context(new_context) {
    if (context == nullptr) throw DeviceError("Modbus server: out of memory");
    modbus_set_indication_timeout(context, 0, kHalfRequestUs);
  }
  ~Link() {
    if (listener >= 0) close(listener);
    if (pty_client >= 0) close(pty_client);
    modbus_free(context);
  }
};

Answer RegisterBank::Write(int, int, std::span<const std::uint16_t>) {
  return Answer::kIllegalFunction;
}

std::unique_ptr<ModbusServer> ModbusServer::ListenTcp(const std::string& host, int port,
                                                      RegisterBank& bank) {
  auto link = std::make_unique<Link>(modbus_new_tcp_pi(host.c_str(), std::to_string(port).c_str()));
  errno = 0;
  link->listener = modbus_tcp_pi_listen(link->context, SOMAXCONN);
  if (link->listener < 0) {
    throw DeviceError(
        fmt::format("Modbus server: cannot listen on {} port {}: {}; take another port "
                    "or an address of this computer",
                    host, port, errno != 0 ? ErrorText(errno) : "the address is not known"));
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
                    line.device, unit, ErrorText(errno)));
  }
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
    throw DeviceError(fmt::format("Modbus server: no pseudo terminal: {}", ErrorText(errno)));
  }
  // The name in the context is never opened: the terminal is handed over as it is.
  auto link = std::make_unique<Link>(modbus_new_rtu(name, 115200, 'N', 8, 1));
  link->listener = ours;
  link->pty_client = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios raw{};
  if (link->pty_client < 0 || tcgetattr(link->pty_client, &raw) != 0 ||
      modbus_set_slave(link->context, unit) != 0) {
    throw DeviceError(fmt::format("Modbus server: cannot serve unit {} on a pseudo terminal: {}",
                                  unit, ErrorText(errno)));
  }
  cfmakeraw(&raw);
  tcsetattr(link->pty_client, TCSANOW, &raw);
  modbus_set_socket(link->context, ours);
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
  std::vector<pollfd> ends{{link_->listener, POLLIN, 0}};
  while (!stop.stop_requested()) {
    if (poll(ends.data(), ends.size(), kStopLookMs) <= 0) continue;
    for (std::size_t i = ends.size(); i-- > 1;) {
      if (ends[i].revents == 0) continue;
      modbus_set_socket(link_->context, ends[i].fd);
      if (AnswerOne()) continue;
      close(ends[i].fd);
      ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (ends[0].revents != 0) {
      int listener = link_->listener;
      const int client = modbus_tcp_pi_accept(link_->context, &listener);
      if (client >= 0) ends.push_back({client, POLLIN, 0});
    }
  }
  for (std::size_t i = 1; i < ends.size(); ++i) close(ends[i].fd);
  modbus_set_socket(link_->context, -1);
}

void ModbusServer::ServeSerial(const std::stop_token& stop) {
  pollfd line{modbus_get_socket(link_->context), POLLIN, 0};
  while (!stop.stop_requested()) {
    if (poll(&line, 1, kStopLookMs) <= 0) continue;
    if (AnswerOne()) continue;
    modbus_flush(link_->context);
    // A line that has hung up reports it at once and for ever.
    if ((line.revents & POLLHUP) != 0) poll(nullptr, 0, kStopLookMs);
  }
}

bool ModbusServer::AnswerOne() {
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> bytes{};
  const int length = modbus_receive(link_->context, bytes.data());
  if (length < 0) return false;
  if (length == 0) return true;  // a serial request for another unit
  Request request = TakeApart(bytes.data(), modbus_get_header_length(link_->context));
  const Answer answer = Ask(bank_, request);
  if (answer == Answer::kSilence) return true;
  ++requests_;
  if (answer != Answer::kOk) {
    return modbus_reply_exception(link_->context, bytes.data(), static_cast<unsigned>(answer)) >= 0;
  }
  // The library writes the reply from a mapping that covers just the registers asked for.
  modbus_mapping_t mapping{};
  const bool input = request.function == kReadInput;
  (input ? mapping.nb_input_registers : mapping.nb_registers) = request.count;
  (input ? mapping.start_input_registers : mapping.start_registers) = request.address;
  (input ? mapping.tab_input_registers : mapping.tab_registers) = request.words.data();
  return modbus_reply(link_->context, bytes.data(), length, &mapping) >= 0;
}

}  // namespace abbe::hal
