// Requests a second for five input registers: abbe's client against a bare libmodbus loop on the
// same loopback server, in one run. The client frames, checks unit and transaction and keeps its
// deadline; it must still reach 80 % of the bare loop.
#include <benchmark/benchmark.h>
#include <modbus/modbus.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <vector>

#include "hal/modbus/modbus_client.h"
#include "hal/modbus/modbus_server.h"

namespace {

using abbe::hal::ModbusServer;
using abbe::hal::RegisterTable;

constexpr int kRegisters = 5;

ModbusServer& Server() {
  static abbe::hal::RegisterImage image;
  static const auto server = [] {
    image.Set(1, RegisterTable::kInput, 0, {1, 2, 3, 4, 5});
    return ModbusServer::ListenTcp("127.0.0.1", 0, image);
  }();
  return *server;
}

class BareLoop {
 public:
  BareLoop() : context_(modbus_new_tcp("127.0.0.1", Server().port())) {
    modbus_set_slave(context_, 1);
    modbus_connect(context_);
  }
  ~BareLoop() {
    modbus_close(context_);
    modbus_free(context_);
  }
  bool Request() {
    std::array<std::uint16_t, kRegisters> words;
    return modbus_read_input_registers(context_, 0, kRegisters, words.data()) == kRegisters;
  }

 private:
  modbus_t* context_;
};

class OurClient {
 public:
  OurClient() : client_(Device()) {}
  bool Request() {
    std::array<std::uint16_t, kRegisters> words;
    return !client_.Read(RegisterTable::kInput, 0, words, client_.Deadline());
  }

 private:
  static abbe::hal::ModbusSettings Device() {
    abbe::hal::ModbusSettings device;
    device.name = "bench";
    device.host = "127.0.0.1";
    device.port = Server().port();
    return device;
  }
  abbe::hal::ModbusClient client_;
};

template <class Client>
void Requests(benchmark::State& state) {
  Client client;
  for (auto _ : state) {
    if (!client.Request()) return state.SkipWithError("the request failed");
  }
  state.SetItemsProcessed(state.iterations());
}

// Both in turn, so that whatever else the computer does falls on both; the median of the ratios.
void RatioOursToBare(benchmark::State& state) {
  constexpr int kBatch = 200;
  OurClient ours;
  BareLoop bare;
  const auto seconds = [](auto& client) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < kBatch; ++i) client.Request();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  std::vector<double> ratios;
  for (auto _ : state) ratios.push_back(seconds(bare) / seconds(ours));
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<long>(ratios.size() / 2),
                   ratios.end());
  state.counters["ratio"] = ratios[ratios.size() / 2];
}

}  // namespace

BENCHMARK(Requests<OurClient>)->Name("modbus/abbe_client")->UseRealTime();
BENCHMARK(Requests<BareLoop>)->Name("modbus/bare_libmodbus")->UseRealTime();
BENCHMARK(RatioOursToBare)->Name("modbus/ratio_to_bare")->Iterations(101)->UseRealTime();
BENCHMARK_MAIN();
