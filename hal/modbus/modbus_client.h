// A Modbus client that never blocks past its deadline and never returns the reply to another
// request.
//
// libmodbus opens and closes the link (TCP connect within a time, serial modes); the frames are
// made and checked in modbus_frame.h. A reply that is found after its time is late, even if this
// program was suspended. After any fault but an exception the link is closed. It is opened again at
// the next call; if that fails too, later calls return at once until the back-off has passed
// (doubled each time). Bytes left over from earlier replies are discarded before each request.
//
// One client belongs to one thread. Several units of one TCP server or one serial line each have
// their own client; on a serial line they must be called in turn, by one thread.
// Units: s of the settings; deadlines in real time.
// Failure: DeviceError for a host name that does not resolve; else a ModbusFault is returned.
// Source: Modbus application protocol V1.1b3; libmodbus for the link.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "hal/clock.h"
#include "hal/modbus/modbus_frame.h"
#include "hal/modbus/modbus_settings.h"

namespace abbe::hal {

struct ModbusFault {
  enum class Kind {
    kNoLink,     // no connection, or the back-off is running
    kTimeout,    // no reply, or half of one
    kBadReply,   // a reply that does not belong to the request, or a broken one
    kSuspended,  // this program did not run while the reply was due: its time is not known
    kException,  // the device refuses; the link stays
  };
  Kind kind;
  int exception;     // for kException
  std::string text;  // "no answer within 200 ms to: read 5 input registers from 0"
};

class ModbusClient {
 public:
  using Time = BootClock::time_point;

  // Looks up the host name (this alone may take longer than a deadline) and opens nothing.
  // DeviceError when the name cannot be resolved.
  explicit ModbusClient(const ModbusSettings& device);
  ~ModbusClient();
  ModbusClient(const ModbusClient&) = delete;
  ModbusClient& operator=(const ModbusClient&) = delete;

  // Reads words.size() registers (1 to 125). Returns the fault, or nothing when all went well;
  // after a fault `words` are unchanged. Returns at the latest at `deadline`.
  std::optional<ModbusFault> Read(RegisterTable table, int address, std::span<std::uint16_t> words,
                                  Time deadline);
  // One holding register, function 6.
  std::optional<ModbusFault> Write(int address, std::uint16_t word, Time deadline);
  // The identification of the device, "vendor product revision"; empty when it has none. A device
  // that is disturbed by the question is given time to recover, its response time at most.
  std::string Identity(Time deadline);

  // `deadline` seconds (of the settings) from now.
  Time Deadline() const;

  bool connected() const { return connected_; }
  std::uint64_t connections() const { return connections_; }  // opened so far

 private:
  struct Link;  // hides libmodbus
  using Fault = std::optional<ModbusFault>;

  Fault Exchange(const ModbusRequest& request, Time deadline);
  Fault Connect(Time deadline);
  Fault Send(std::span<const std::uint8_t> frame, const ModbusRequest& request);
  Fault Receive(const ModbusRequest& request, Time deadline);
  Fault Drop(ModbusFault::Kind kind, std::string text);  // closes the link, sets the back-off
  void WaitForSilence(Time deadline) const;

  ModbusSettings device_;
  std::unique_ptr<Link> link_;
  bool connected_ = false;
  std::uint64_t connections_ = 0;
  std::uint16_t transaction_ = 0;
  double backoff_s_ = 0.0;  // 0: the next attempt is at once
  Time retry_at_{};
  Time quiet_since_{};
  std::string last_fault_;
  std::array<std::uint8_t, kLongestFrame> reply_{};
  std::size_t reply_size_ = 0;
  std::span<const std::uint8_t> words_, objects_;  // of the last good reply
};

}  // namespace abbe::hal
