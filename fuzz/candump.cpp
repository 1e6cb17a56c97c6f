// `hal/can/candump_log.h` and what becomes of a log as a recording (`hal/can/candump_recording.h`).
#include "fuzz/target.h"
#include "hal/can/candump_recording.h"

namespace abbe::fuzz::candump {

hal::CanopenSettings Device() {
  const auto machine = settings::Document::Parse(
      "transport = \"canopen\"\ninterface = \"can0\"\nnode = [\n"
      "{ id = 1, name = \"pivot_1_rad\", counts_per_turn = 65536, range = 65536, at_bit = 4, "
      "bits = 20, signed = true },\n"
      "{ id = 2, name = \"pivot_2_rad\", counts_per_turn = 16777216, range = 16777216 }]\n",
      "machine.toml");
  const auto root = machine.Root();
  root.Choice("transport", {"canopen"}, true);
  return hal::ReadCanopen(root);
}

void Read(Bytes bytes) {
  static const hal::CanopenSettings device = Device();
  const hal::CandumpLog log = hal::ReadCandump(InputFile(bytes).path());
  for (std::size_t i = 1; i < log.frames.size(); ++i) {
    Require(log.frames[i].time_s >= log.frames[i - 1].time_s, "stamps of a log never go back");
  }
  hal::RecordingOf(log, device, 1.0, "fuzz");
}

}  // namespace abbe::fuzz::candump
