// `abbe record`: records all devices of the machine file for a time, on one clock.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/interrupt.h"
#include "apps/live_view.h"
#include "apps/machine_file.h"
#include "apps/plausible_channels.h"
#include "apps/progress.h"
#include "apps/protocol.h"
#include "hal/combined_source.h"
#include "hal/recorder.h"
#include "hal/sweep_recorder.h"
#include "recording/instant.h"

namespace abbe::apps {
namespace {

struct RecordCommand {
  std::string machine, operator_name;
  std::filesystem::path out;
  double seconds = std::numeric_limits<double>::infinity();
  double clock_speed = 1.0;
  std::vector<std::string> devices;  // empty: all
  std::optional<int> program;
  bool passes_only = false;
  bool quiet = false;
  LiveOptions live;
};

// Keeps the requested devices only.
void Select(const RecordCommand& options, hal::DevicesSettings& devices) {
  if (options.devices.empty()) return;
  std::set<std::string> unknown(options.devices.begin(), options.devices.end());
  const auto unwanted = [&](const auto& device) {
    unknown.erase(device->name());
    return std::ranges::find(options.devices, device->name()) == options.devices.end();
  };
  std::erase_if(devices.devices, unwanted);
  if (unknown.empty()) return;
  throw InputError(fmt::format("--devices: {} has no table [devices.{}]; name one of its devices",
                               options.machine, *unknown.begin()));
}

void RequireForOptions(const RecordCommand& options, const hal::OpenedDevices& devices) {
  if (options.program && !devices.start_cycle) {
    throw InputError(fmt::format(
        "--start: no device of {} that is recorded has a cycle_start register; add it or start the "
        "machine's program by hand",
        options.machine));
  }
  const auto& channels = devices.source->channels();
  if (options.passes_only &&
      std::ranges::find(channels, "pass", &hal::Channel::name) == channels.end()) {
    throw InputError(fmt::format(
        "--passes-only: no device of {} that is recorded has a channel \"pass\"; add it or record "
        "all rows",
        options.machine));
  }
}

hal::RecordOutcome RecordDevices(const RecordCommand& options, const MachineFile& file,
                                 LiveView* view) {
  hal::SteadyClock clock(options.clock_speed);
  const PlausibleDevices opened = OpenPlausible(file, file.devices, 1, clock);
  const hal::OpenedDevices& devices = opened.devices;
  hal::PlausibleSource& source = *opened.source;
  const auto& channels = source.channels();
  RequireForOptions(options, devices);
  const auto columns = hal::RecordColumns(channels);
  const auto writer = Watched(
      view,
      recording::Writer::Create(
          options.out,
          hal::RecordHeader({file.sweep_setup.machine.name, recording::UtcNow(), devices.transport},
                            channels) +
              ProtocolText(file.document, options.operator_name),
          columns),
      columns, options.out);
  const bool endless = std::isinf(options.seconds);
  Progress progress("record", options.quiet || endless);
  hal::RecordOptions record;
  record.rate = file.devices.rate;
  record.seconds = options.seconds;
  record.passes_only = options.passes_only;
  record.stopped = [] { return InterruptFlag().load(); };
  const std::size_t total = endless ? 0 : static_cast<std::size_t>(std::ceil(options.seconds));
  LiveState shown;
  record.progress = [&](double elapsed_s, const std::string& fault) {
    const auto done = static_cast<std::size_t>(elapsed_s);
    if (!endless) progress.Show(done, total, fault);
    if (view == nullptr || (done == shown.done && fault == shown.fault)) return;
    shown = {done, total, elapsed_s / options.clock_speed, "Recording", fault};
    view->Show(shown);
  };
  if (endless && !options.quiet) fmt::print(stderr, "recording until Ctrl-C\n");
  if (options.program) devices.start_cycle(*options.program);
  return hal::Record(source, clock, *writer, record);
}

int Record(const RecordCommand& options) {
  MachineFile file = ReadMachineFile(options.machine);
  Select(options, file.devices);
  file.RequireDevices();
  InterruptFlag();
  const auto folder = std::filesystem::absolute(options.out).parent_path();
  const auto view =
      OpenLive(options.live, {.title = "Recording", .folder = folder, .ranges = GapRanges(file)});
  const hal::RecordOutcome outcome = RecordDevices(options, file, view.get());
  if (view) view->End("Finished");
  if (!outcome.worst_channel.empty()) {
    fmt::print(stderr, "abbe: {}: {} of {} rows are flagged; {}{}{}\n", options.out.string(),
               outcome.flagged, outcome.rows, outcome.worst_channel,
               outcome.fault.empty() ? "" : "; at the end: ", outcome.fault);
  }
  if (!options.quiet) {
    fmt::print(
        "recorded {} rows in {:.1f} s in {} ({} flagged, skew {:.2f} ms on average, {:.2f} "
        "ms at worst)\n",
        outcome.rows, outcome.seconds, options.out.string(), outcome.flagged,
        1e3 * outcome.mean_skew_s, 1e3 * outcome.worst_skew_s);
  }
  return kDone;
}

}  // namespace

void AddRecord(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<RecordCommand>();
  CLI::App* command = program.add_subcommand(
      "record", "Record all devices of a machine file: probes, encoders, positions, temperatures");
  command->add_option("machine", options->machine, "the machine file")->required();
  command->add_option("-o,--out", options->out, "the new recording (.csv, .h5, .hdf5)")->required();
  command->add_option("--operator", options->operator_name,
                      "who measures (default: [protocol] of the machine file)");
  command->add_option("--seconds", options->seconds, "duration in s (default: until Ctrl-C)")
      ->check(PositiveNumber());
  command
      ->add_option("--clock-speed", options->clock_speed,
                   "for a virtual machine that runs faster by this factor")
      ->check(PositiveNumber());
  command
      ->add_option("--devices", options->devices,
                   "only these tables [devices.NAME] (default: all): --devices machine,linkage")
      ->delimiter(',');
  command
      ->add_option(
          "--start", options->program,
          "write this number to the machine's cycle_start register when all devices answer")
      ->check(CLI::Range(1, 65535));
  command->add_flag("--passes-only", options->passes_only,
                    "no rows while the channel `pass` is 0: the way to the path and back");
  AddLiveOptions(*command, options->live);
  command->add_flag("--quiet", options->quiet, "print nothing but problems");
  command->footer(
      "Example: abbe record mill.toml --devices machine,linkage --seconds 60 -o circle.csv");
  command->callback([options, &exit_code] { exit_code = Record(*options); });
}

}  // namespace abbe::apps
