// A small Modbus server: TCP with any number of clients and unit ids, or one unit on a
// serial line. It answers from a RegisterBank, which the virtual rig and the tests implement.
//
//   RegisterImage image;                                     // or an own RegisterBank
//   image.Set(1, RegisterTable::kInput, 0, {1000, 2000});    // unit 1
//   const auto server = ModbusServer::ListenTcp("127.0.0.1", 0, image);
//   server->port();                                          // the free port that was found
//
// The bank is called on the server's own thread, one call at a time, at the moment of the request.
// A client that sends half a request, or takes no reply, does not delay the others; its link is
// closed.
// Units: none; 16-bit words.
// Failure: DeviceError where it cannot listen; a bad request gets an exception code or no answer.
// Source: Modbus application protocol V1.1b3.
// Validity: functions 3, 4, 6, 16 and 43.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "failure/failure.h"
#include "hal/modbus/register_table.h"
#include "hal/modbus/serial_line.h"

namespace abbe::hal {

// How a server answers: with the registers, with an exception code, or not at all.
enum class Answer : std::uint8_t {
  kOk = 0,
  kIllegalFunction = 1,
  kIllegalAddress = 2,
  kIllegalValue = 3,
  kDeviceFailure = 4,
  kAcknowledge = 5,
  kBusy = 6,
  kNoSuchUnit = 11,  // "gateway target device failed to respond"
  kSilence = 255,
};

class RegisterBank {
 public:
  virtual ~RegisterBank() = default;
  // Fills `words` with the registers address, address + 1, ... of a unit (1 to 125 words).
  virtual Answer Read(int unit, RegisterTable table, int address,
                      std::span<std::uint16_t> words) = 0;
  // Writes holding registers (1 to 123 words). By default all are read-only.
  virtual Answer Write(int unit, int address, std::span<const std::uint16_t> words);
  // The identification of a unit: vendor, product, revision (function 43); empty: none.
  virtual std::vector<std::string> Identity(int unit);
};

// Registers kept in memory, safe to change from any thread; unknown registers are an illegal
// address, unknown units no such unit. Holding registers that exist can be written.
class RegisterImage : public RegisterBank {
 public:
  // Makes the registers address, address + 1, ... or changes them.
  void Set(int unit, RegisterTable table, int address, std::initializer_list<std::uint16_t> words);
  void Set(int unit, RegisterTable table, int address, std::span<const std::uint16_t> words);
  std::uint16_t Get(int unit, RegisterTable table, int address) const;  // 0 when unknown

  Answer Read(int unit, RegisterTable table, int address, std::span<std::uint16_t> words) override;
  Answer Write(int unit, int address, std::span<const std::uint16_t> words) override;

 private:
  using Key = std::tuple<int, RegisterTable, int>;
  bool HasUnit(int unit) const;

  mutable std::mutex mutex_;
  std::map<Key, std::uint16_t> words_;
};

class ModbusServer {
 public:
  // Listens when it returns. `host` is a numeric address or a name of this computer; port 0 takes a
  // free one. DeviceError when the port is taken or the address is not ours. The bank must outlive
  // the server.
  static std::unique_ptr<ModbusServer> ListenTcp(const std::string& host, int port,
                                                 RegisterBank& bank);
  // Serves one unit on a serial device. DeviceError when it cannot be opened.
  static std::unique_ptr<ModbusServer> OpenSerial(const SerialLine& line, int unit,
                                                  RegisterBank& bank);
  // Serves one unit on a new pseudo terminal, to which a client connects as to a serial device with
  // the name device().
  static std::unique_ptr<ModbusServer> OpenPty(int unit, RegisterBank& bank);

  // Stops answering, within 50 ms.
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  int port() const { return port_; }                     // TCP
  const std::string& device() const { return device_; }  // serial: the client's end
  std::uint64_t requests() const { return requests_; }   // answered so far, exceptions included

 private:
  struct Link;  // hides libmodbus
  ModbusServer(std::unique_ptr<Link> link, RegisterBank& bank);
  struct Client;
  void ServeTcp(const std::stop_token& stop);
  void ServeSerial(const std::stop_token& stop);
  bool AnswerTcp(Client& client);  // false: this connection is over
  void AnswerSerial(Client& client, std::size_t length);

  std::unique_ptr<Link> link_;
  RegisterBank& bank_;
  int port_ = 0;
  std::string device_;
  std::atomic<std::uint64_t> requests_{0};
  std::jthread thread_;  // last: stops before the rest goes
};

}  // namespace abbe::hal
