#include "hal/modbus/example_devices.h"

#include <fmt/format.h>

namespace abbe::hal {
namespace {

constexpr std::string_view kExampleDevices = R"(
# The devices, here over Modbus TCP: the amplifier of the probes and the control with its scales. Enter addresses and
# registers of yours (docs/devices.md); "abbe doctor --machine FILE" says whether they answer.
[devices]
rate_hz = 200.0
max_skew_ms = 20.0
stale_ms = 1000.0

[devices.head]
transport = "modbus-tcp"
host = "127.0.0.1"
port = 1502
unit = 1
[[devices.head.block]]
function = "input"
address = 0
count = 5
channel = [
  { name = "probe_a_um", at = 0, type = "uint16", scale = 0.0030517578125, sentinels = [65535] },
  { name = "probe_b_um", at = 1, type = "uint16", scale = 0.0030517578125, sentinels = [65535] },
  { name = "probe_c_um", at = 2, type = "uint16", scale = 0.0030517578125, sentinels = [65535] },
  { name = "probe_d_um", at = 3, type = "uint16", scale = 0.0030517578125, sentinels = [65535] },
  { name = "probe_e_um", at = 4, type = "uint16", scale = 0.0030517578125, sentinels = [65535] },
]

[devices.machine]
transport = "modbus-tcp"
host = "127.0.0.1"
port = 1502
unit = 2
cycle_start = { function = "holding", address = 100 }
[[devices.machine.block]]
function = "holding"
address = 0
count = 11
channel = [
)";

constexpr std::string_view kExampleControl =
    R"(  { name = "temp_column_c", at = 6, type = "int16", scale = 0.01, may_freeze = true },
  { name = "temp_table_c", at = 7, type = "int16", scale = 0.01, may_freeze = true },
  { name = "pass", at = 8, type = "uint16", may_freeze = true },
  { name = "direction", at = 9, type = "int16", may_freeze = true },
  { name = "feed_mm_min", at = 10, type = "uint16", may_freeze = true },
]
)";

}  // namespace

std::string ExampleModbusDevices(std::string_view axes) {
  std::string text(kExampleDevices);
  for (const char axis : axes) {
    text += fmt::format(
        "  {{ name = \"{}_mm\", at = {}, type = \"int32\", order = \"ABCD\", scale = 0.00001, "
        "may_freeze = true }},\n",
        static_cast<char>(axis - 'A' + 'a'), 2 * (axis - 'X'));
  }
  return text + std::string(kExampleControl);
}

}  // namespace abbe::hal
