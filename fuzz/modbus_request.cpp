// What a client may send to the server of the virtual rig (`hal/modbus/modbus_server.h`), over TCP:
// whatever it was, what comes back are replies of the protocol, and the next client is served as
// ever.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <vector>

#include "fuzz/target.h"
#include "hal/modbus/modbus_server.h"

namespace abbe::fuzz::modbus_request {

constexpr std::size_t kHead = 7;  // transaction, protocol, length, unit

int Connect(int port) {
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Require(connect(client, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0,
          "the server takes a client");
  return client;
}

// What the server answers to `bytes` until it has answered all and the connection is over.
std::vector<std::uint8_t> Exchange(int port, Bytes bytes) {
  const int client = Connect(port);
  const linger at_once{1, 0};  // leaves no port behind that waits
  setsockopt(client, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  if (!bytes.empty()) send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  shutdown(client, SHUT_WR);
  std::vector<std::uint8_t> replies;
  std::array<std::uint8_t, 1024> buffer;
  for (ssize_t size; (size = recv(client, buffer.data(), buffer.size(), 0)) > 0;) {
    replies.insert(replies.end(), buffer.begin(), buffer.begin() + size);
  }
  close(client);
  return replies;
}

void Read(Bytes bytes) {
  static hal::RegisterImage image;
  static const auto server = [] {
    image.Set(1, hal::RegisterTable::kInput, 0, {1000, 2000, 3000});
    image.Set(1, hal::RegisterTable::kHolding, 0, {1, 2, 3});
    return hal::ModbusServer::ListenTcp("127.0.0.1", 0, image);
  }();
  const auto replies =
      Exchange(server->port(), bytes.first(std::min<std::size_t>(bytes.size(), 4096)));
  for (std::size_t at = 0; at < replies.size();) {
    Require(replies.size() - at >= kHead + 2, "a reply is whole");
    Require(replies[at + 2] == 0 && replies[at + 3] == 0, "a reply is Modbus");
    at += 6 + (std::size_t{replies[at + 4]} << 8 | replies[at + 5]);
    Require(at <= replies.size(), "a reply has the length that it says");
  }
  const std::array<std::uint8_t, 12> request{0, 9, 0, 0, 0, 6, 1, 4, 0, 1, 0, 2};
  const std::vector<std::uint8_t> wanted{0, 9, 0, 0, 0, 7, 1, 4, 4, 0x07, 0xD0, 0x0B, 0xB8};
  Require(Exchange(server->port(), request) == wanted, "the next client is served");
}

}  // namespace abbe::fuzz::modbus_request
