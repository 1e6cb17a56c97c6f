// `abbe sweep`: measures one axis with the head, records every row, and
// reduces, prints and writes the result.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "apps/causes_option.h"
#include "apps/command.h"
#include "apps/doubted_sweep.h"
#include "apps/growing_sweep.h"
#include "apps/interrupt.h"
#include "apps/live_view.h"
#include "apps/machine_file.h"
#include "apps/mounting_file.h"
#include "apps/plausible_channels.h"
#include "apps/progress.h"
#include "apps/protocol.h"
#include "apps/reduce_sweep.h"
#include "apps/result_file.h"
#include "hal/combined_source.h"
#include "hal/sweep_recorder.h"
#include "recording/instant.h"

namespace abbe::apps {
namespace {

struct SweepCommand {
  std::string axis;
  std::string machine;
  CausesOption causes;
  std::filesystem::path out = "out";
  std::string json;
  std::string mounting, operator_name;
  double clock_speed = 1.0;
  bool hdf5 = false;
  bool prompt = false;
  bool quiet = false;
  LiveOptions live;
};

// OUT/sweep_X.csv, or the first of sweep_X_2.csv, sweep_X_3.csv ... that is free: nothing measured
// is ever overwritten.
std::filesystem::path FreeName(const SweepCommand& options) {
  const std::string extension = options.hdf5 ? ".h5" : ".csv";
  for (int number = 1;; ++number) {
    const std::string suffix = number == 1 ? "" : fmt::format("_{}", number);
    const auto path = options.out / fmt::format("sweep_{}{}", options.axis, suffix);
    if (!std::filesystem::exists(path.string() + ".csv") &&
        !std::filesystem::exists(path.string() + ".h5")) {
      return path.string() + extension;
    }
  }
}

// Asks the operator to move the axis; false when the input has ended or the sweep is interrupted.
bool AskOperator(const hal::SweepPlan& plan, const hal::Visit& visit) {
  fmt::print("pass {} of {}, coming from {}: move {} to {:.3f} mm, then press Enter ", visit.pass,
             plan.passes, visit.direction > 0 ? "below" : "above", plan.axis,
             1e3 * plan.stations[visit.station]);
  std::cout.flush();
  std::string line;
  return static_cast<bool>(std::getline(std::cin, line)) && !InterruptFlag();
}

std::string NoteOf(const hal::SweepPlan& plan, const hal::SweepProgress& progress) {
  if (!progress.fault.empty()) return progress.fault;
  if (progress.visits_done == 0) return "waiting for the first station";
  const hal::Visit visit = plan.Visits()[progress.visits_done - 1];
  return fmt::format("{} {:.3f} mm, pass {} {}", plan.axis, 1e3 * plan.stations[visit.station],
                     visit.pass, visit.direction > 0 ? "forward" : "backward");
}

hal::SweepOutcome Record(const SweepCommand& options, const MachineFile& file,
                         const hal::SweepPlan& plan, const std::filesystem::path& path,
                         LiveView* view) {
  hal::SteadyClock clock(options.clock_speed);
  const bool operator_asks = options.prompt;
  const PlausibleDevices opened =
      OpenPlausible(file, hal::WithoutEncoders(file.devices), kFirstReadings, clock);
  const hal::OpenedDevices& devices = opened.devices;
  hal::PlausibleSource& source = *opened.source;
  for (const std::string& warning : opened.warnings) fmt::print(stderr, "abbe: {}\n", warning);
  // An alignment into the same folder says the set-up, unless another is named.
  const MountingFile aligned = ReadMounting(options.out).value_or(MountingFile{});
  const bool as_aligned = options.mounting.empty() || options.mounting == aligned.id;
  const hal::SweepAbout about{.machine = file.sweep_setup.machine.name,
                              .started = recording::UtcNow(),
                              .mounting = as_aligned ? aligned.id : options.mounting,
                              .more = (as_aligned ? AlignedText(aligned, plan.axis) : "") +
                                      ProtocolText(file.document, options.operator_name),
                              .transport = devices.transport};
  const auto& channels = source.channels();
  const auto columns = hal::SweepColumns(channels);
  const auto writer = Watched(
      view, recording::Writer::Create(path, hal::SweepHeader(plan, about, channels), columns),
      columns, path);
  GrowingSweep growing(view, plan, file.sweep_setup, path);

  const auto warn = [&source] {
    for (const std::string& each : source.TakeWarnings()) fmt::print(stderr, "abbe: {}\n", each);
  };
  Progress progress(fmt::format("sweep {}", plan.axis), options.quiet || operator_asks);
  hal::SweepOptions sweep;
  sweep.rate = file.devices.rate;
  sweep.stopped = [] { return InterruptFlag().load(); };
  sweep.progress = [&](const hal::SweepProgress& at) {
    progress.Show(at.visits_done, at.visits_total, NoteOf(plan, at));
    growing.VisitsDone(at.visits_done);
    warn();
    if (view != nullptr) {
      view->Show({at.visits_done, at.visits_total, at.elapsed_s / options.clock_speed,
                  NoteOf(plan, at), at.fault});
    }
  };
  if (operator_asks) {
    sweep.prompt = [&](const hal::Visit& visit) { return AskOperator(plan, visit); };
    sweep.refused = [](const std::string& why) { fmt::print(stderr, "abbe: {}\n", why); };
  } else if (devices.start_cycle) {
    devices.start_cycle(plan.axis - 'X' + 1);
  } else if (!options.quiet) {
    fmt::print("start the machine's program for {} now\n", plan.axis);
  }
  const hal::SweepOutcome outcome = hal::RecordSweep(source, plan, clock, *writer, sweep);
  warn();
  return outcome;
}

// Reports why the sweep ended early and what to do; the recording is kept in any case.
void RefuseUnfinished(const hal::SweepOutcome& outcome, const std::filesystem::path& path) {
  if (outcome.end == hal::SweepEnd::kComplete) return;
  const std::string kept = fmt::format("{} rows are kept in {}; `abbe reduce` evaluates them",
                                       outcome.rows, path.string());
  if (outcome.end == hal::SweepEnd::kStopped) {
    throw DeviceError(fmt::format("interrupted after {:.0f} s: {}", outcome.seconds, kept));
  }
  throw DeviceError(fmt::format("the sweep ended before its last station: {}{}{}: {}",
                                NameOf(outcome.end), outcome.fault.empty() ? "" : ": ",
                                outcome.fault, kept));
}

void WarnOfLackingVisits(const hal::SweepOutcome& outcome, const hal::SweepPlan& plan) {
  if (outcome.lacking.empty()) return;
  const hal::Visit& first = outcome.lacking.front();
  fmt::print(stderr,
             "abbe: {} of {} visits lack good readings, the first at {:.3f} mm in pass {}{}{}\n",
             outcome.lacking.size(), plan.Visits().size(), 1e3 * plan.stations[first.station],
             first.pass, outcome.worst_channel.empty() ? "" : "; ", outcome.worst_channel);
}

int Sweep(const SweepCommand& options) {
  const MachineFile file = ReadMachineFile(options.machine);
  file.RequireDevices();
  const hal::SweepPlan& plan = file.SweepPlanOf(options.axis[0]);
  CauseCorrection causes(options.causes, file, kForMaps);
  InterruptFlag();
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot be made: {}; choose another folder with --out",
                                 options.out.string(), error.message()));
  }
  const std::filesystem::path path = FreeName(options);
  const auto view = OpenLive(options.live, {.title = fmt::format("Sweep {}", plan.axis),
                                            .folder = options.out,
                                            .ranges = GapRanges(file)});
  const hal::SweepOutcome outcome = Record(options, file, plan, path, view.get());
  if (outcome.end != hal::SweepEnd::kComplete && view) {
    view->End(fmt::format("Ended early: {}", hal::NameOf(outcome.end)));
  }
  RefuseUnfinished(outcome, path);
  WarnOfLackingVisits(outcome, plan);

  const recording::Recording recording = recording::Read(path);
  const probes::SweepResult result = ReduceCorrected(recording, file.sweep_setup, causes);
  auto json = SweepJson(result);
  AddProtocol(recording, json);
  if (causes.Active()) json["causes_taken_out"] = causes.Data();
  auto beside = path;
  WriteResult(json, options.json.empty() ? beside.replace_extension(".json")
                                         : std::filesystem::path(options.json));
  if (view) view->End("Finished");
  if (!options.quiet) {
    fmt::print("{}", SweepTable(result));
    if (causes.Active()) fmt::print("{}\n", causes.Line());
    fmt::print("recorded {} rows in {} ({} flagged, worst skew {:.1f} ms)\n", outcome.rows,
               path.string(), outcome.flagged, 1e3 * outcome.worst_skew_s);
  }
  return kDone;
}

}  // namespace

void AddSweep(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<SweepCommand>();
  CLI::App* command = program.add_subcommand("sweep", "Measure an axis with the five-probe head");
  command->add_option("--axis", options->axis, "the axis: X, Y or Z")
      ->required()
      ->check(CLI::IsMember({"X", "Y", "Z"}));
  command->add_option("--machine", options->machine, "the machine file")->required();
  AddCausesOption(*command, options->causes);
  command->add_option("--out", options->out, "folder of the recording and the result")
      ->capture_default_str();
  command->add_option("--json", options->json,
                      "the result as data (default: beside the recording)");
  command->add_option(
      "--mounting", options->mounting,
      "name of this set-up of head and target; sweeps that share it can give squareness");
  command->add_flag("--hdf5", options->hdf5, "record as HDF5 instead of CSV");
  command->add_option("--operator", options->operator_name,
                      "who measures (default: [protocol] of the machine file)");
  command->add_flag("--prompt", options->prompt, "ask the operator to move to each station");
  command
      ->add_option("--clock-speed", options->clock_speed,
                   "for a virtual machine that runs faster by this factor")
      ->check(PositiveNumber());
  AddLiveOptions(*command, options->live);
  command->add_flag("--quiet", options->quiet, "print nothing but problems");
  command->footer("Example: abbe sweep --axis X --machine mill.toml --out measured");
  command->callback([options, &exit_code] { exit_code = Sweep(*options); });
}

}  // namespace abbe::apps
