// A Modbus TCP device that misbehaves on request: one fault of the table in the design for each
// request of a script, then well-behaved for ever. Raw sockets and frames written by hand, so that
// nothing is shared with the client under test. Register k holds 1000 + k.
#pragma once

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace abbe::hal {

enum class Misdeed {
  kNone,
  kLate,       // 100 ms after the client has given up
  kSilent,     // no reply
  kTruncated,  // the second half never comes
  kWrongTransaction,
  kWrongProtocol,
  kWrongFunction,
  kTooFewRegisters,
  kWrongUnit,
  kException4,
  kException6,
  kReset,       // RST
  kClose,       // orderly end
  kDrip,        // one byte each 20 ms
  kTwice,       // the same reply two times, in one piece
  kTwiceApart,  // the same reply again 20 ms later
  kGarbage,     // bytes that are no frame
};

class ScriptedModbusServer {
 public:
  explicit ScriptedModbusServer(std::vector<Misdeed> script, int late_ms = 300)
      : script_(std::move(script)), late_ms_(late_ms) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    if (bind(listener_, generic, size) != 0 || listen(listener_, 8) != 0 ||
        getsockname(listener_, generic, &size) != 0) {
      throw std::runtime_error("scripted server: cannot listen on loopback");
    }
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { Serve(stop); });
  }
  ~ScriptedModbusServer() {
    thread_.request_stop();
    thread_.join();
    close(listener_);
  }
  ScriptedModbusServer(const ScriptedModbusServer&) = delete;

  int port() const { return port_; }
  int connections() const { return connections_; }

 private:
  using Bytes = std::vector<std::uint8_t>;

  void Serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd end{listener_, POLLIN, 0};
      if (poll(&end, 1, 10) <= 0) continue;
      const int client = accept(listener_, nullptr, nullptr);
      ++connections_;
      while (!stop.stop_requested() && AnswerOne(client, stop)) {
      }
      close(client);
    }
  }

  // false: this connection is over.
  bool AnswerOne(int client, const std::stop_token& stop) {
    pollfd end{client, POLLIN, 0};
    while (poll(&end, 1, 10) == 0) {
      if (stop.stop_requested()) return false;
    }
    std::array<std::uint8_t, 12> request{};
    if (recv(client, request.data(), request.size(), MSG_WAITALL) != 12) return false;
    const Misdeed misdeed = at_ < script_.size() ? script_[at_++] : Misdeed::kNone;
    return Misbehave(client, misdeed, GoodReply(request));
  }

  static Bytes GoodReply(const std::array<std::uint8_t, 12>& request) {
    const int address = request[8] << 8 | request[9], count = request[10] << 8 | request[11];
    Bytes reply{request[0], request[1], 0,
                0,          0,          static_cast<std::uint8_t>(3 + 2 * count),
                request[6], request[7], static_cast<std::uint8_t>(2 * count)};
    for (int i = 0; i < count; ++i) {
      reply.push_back(static_cast<std::uint8_t>((1000 + address + i) >> 8));
      reply.push_back(static_cast<std::uint8_t>((1000 + address + i) & 0xFF));
    }
    return reply;
  }

  bool Misbehave(int client, Misdeed misdeed, Bytes reply) {
    switch (misdeed) {
      case Misdeed::kNone:
        break;
      case Misdeed::kLate:
        poll(nullptr, 0, late_ms_);
        break;
      case Misdeed::kSilent:
        return true;
      case Misdeed::kTruncated:
        reply.resize(reply.size() / 2);
        break;
      case Misdeed::kWrongTransaction:
        reply[1] ^= 0x10;
        break;
      case Misdeed::kWrongProtocol:
        reply[3] = 1;
        break;
      case Misdeed::kWrongFunction:
        reply[7] ^= 7;  // 4 for 3 and 3 for 4
        break;
      case Misdeed::kTooFewRegisters:
        reply.resize(reply.size() - 2);
        reply[5] = static_cast<std::uint8_t>(reply[5] - 2);
        reply[8] = static_cast<std::uint8_t>(reply[8] - 2);
        break;
      case Misdeed::kWrongUnit:
        ++reply[6];
        break;
      case Misdeed::kException4:
      case Misdeed::kException6:
        reply.resize(9);
        reply[5] = 3;
        reply[7] |= 0x80;
        reply[8] = misdeed == Misdeed::kException4 ? 4 : 6;
        break;
      case Misdeed::kReset: {
        const linger now{1, 0};
        setsockopt(client, SOL_SOCKET, SO_LINGER, &now, sizeof now);
        return false;
      }
      case Misdeed::kClose:
        return false;
      case Misdeed::kDrip:
        for (const std::uint8_t byte : reply) {
          poll(nullptr, 0, 20);
          if (!Send(client, {byte})) return false;
        }
        return true;
      case Misdeed::kTwice: {
        const Bytes again = reply;
        reply.insert(reply.end(), again.begin(), again.end());
        break;
      }
      case Misdeed::kTwiceApart:
        if (!Send(client, reply)) return false;
        poll(nullptr, 0, 20);
        break;
      case Misdeed::kGarbage:
        reply.assign(40, 0x55);
        break;
    }
    return Send(client, reply);
  }

  static bool Send(int client, const Bytes& bytes) {
    return send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }

  std::vector<Misdeed> script_;
  int late_ms_;
  std::size_t at_ = 0;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<int> connections_{0};
  std::jthread thread_;  // last: stops before the rest goes
};

}  // namespace abbe::hal
