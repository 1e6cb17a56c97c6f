// abbe rig: serves the virtual rig, or records a sweep or a course of it directly.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/campaign_kinds.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/interrupt.h"
#include "apps/result_file.h"
#include "apps/rig_compare.h"
#include "apps/rig_course.h"
#include "apps/rig_hands.h"
#include "hal/device_settings.h"
#include "hal/sweep_recorder.h"
#include "recording/instant.h"
#include "recording/recording_file.h"
#include "rig/ageing.h"
#include "rig/campaign.h"
#include "rig/encoder_server.h"
#include "rig/record_course.h"
#include "rig/record_lengths.h"
#include "rig/record_plate.h"
#include "rig/record_sweep.h"
#include "rig/register_server.h"
#include "rig/truth.h"

namespace abbe::apps {
namespace {

struct RigOptions {
  std::string machine;
  std::uint64_t seed = 1;
  std::optional<int> port;
  double speed = 1.0;
  std::vector<std::string> rtu;    // DEVICE=LINK
  std::optional<std::string> can;  // the interface; empty: those of the machine file
  std::filesystem::path truth, ready_file, out;
  std::string start, axis, length, mounting, campaign;
  bool reduced = false;
  bool hands = false;
  std::vector<std::string> hide;
  CourseRequest course;
  bool plate = false, both_ways = false;
  double rate = 200.0;
  double after_days = 0.0;
  std::filesystem::path truth_to_compare;
  std::vector<std::filesystem::path> results;
};

// The simulated world and the devices of the same file.
struct Rig {
  explicit Rig(const RigOptions& options)
      : document(settings::Document::Read(options.machine)),
        machine(rig::ReadCampaignMachine(document.Root())),
        world(rig::Ageing(machine.rig, options.seed)
                  .WorldAt(options.after_days, Hidden(machine, options))),
        devices(hal::ReadDevices(document.Root().Child("devices"))) {
    if (machine.linkage) {
      linkage.emplace(world, rig::Linkage(*machine.linkage, options.seed, world.hidden()));
    }
    WriteTruth(options, world.hidden());
  }

  // The effects of --hide; instants that it does not give are drawn in the first ten minutes.
  static rig::HiddenEffects Hidden(const rig::CampaignMachine& machine, const RigOptions& options) {
    rig::HiddenEffects hidden = HiddenOf(machine, options);
    rig::SetInTime(hidden, {{0.0, 600.0, true, true}});
    return hidden;
  }
  static rig::HiddenEffects HiddenOf(const rig::CampaignMachine& machine,
                                     const RigOptions& options) {
    rig::HiddenEffects hidden;
    for (const std::string& text : options.hide) {
      hidden.push_back(rig::ParseHidden(text, options.seed, machine.sensors));
    }
    return hidden;
  }

  void WriteTruth(const RigOptions& options, const rig::HiddenEffects& hidden) const {
    if (options.truth.empty()) return;
    nlohmann::ordered_json truth = rig::TruthOf(world);
    truth["hidden"] = rig::TruthOf(hidden);
    if (linkage) truth["linkage"] = linkage->Truth();
    WriteResult(truth, options.truth);
  }

  settings::Document document;
  rig::CampaignMachine machine;
  rig::World world;
  hal::DevicesSettings devices;
  std::optional<rig::LinkageRig> linkage;
};

rig::ServerOptions PlaceToListen(const Rig& rig, const RigOptions& options) {
  rig::ServerOptions server = rig::AddressOf(rig.devices);
  if (options.port) server.port = *options.port;
  return server;
}

// Makes the symbolic link that a client opens; it replaces a link of an earlier rig, never a file.
std::string ServeRtu(rig::RegisterServer& server, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw InputError(fmt::format("--rtu {}: must be DEVICE=LINK, such as head=/tmp/head", text));
  }
  const std::filesystem::path link = text.substr(equals + 1);
  const std::string terminal = server.OpenRtu(text.substr(0, equals));
  std::error_code error;
  if (std::filesystem::is_symlink(link)) std::filesystem::remove(link, error);
  std::filesystem::create_symlink(terminal, link, error);
  if (error) {
    throw InputError(fmt::format("--rtu {}: cannot make the link: {}; choose another place", text,
                                 error.message()));
  }
  return link;
}

void WriteReadyFile(const std::filesystem::path& path, int port) {
  WriteText(fmt::format("{}\n", port), path);
}

// The machine of the rig with its program, on the requested interfaces.
class Served {
 public:
  Served(const Rig& rig, const RigOptions& options)
      : place_(PlaceToListen(rig, options)),
        machine_(rig.world, rig::SimulatedTime(options.speed),
                 rig.linkage ? &*rig.linkage : nullptr, CourseToRun(rig, options),
                 options.course.cap_force_n),
        registers_(machine_, rig.devices, place_) {
    for (const std::string& text : options.rtu) links_.emplace_back(ServeRtu(registers_, text));
    if (options.can) ServeCan(rig, options);
    if (!options.start.empty()) Start(options);
  }
  ~Served() {
    std::error_code ignored;
    for (const auto& link : links_) std::filesystem::remove(link, ignored);
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  int port() const { return registers_.port(); }
  rig::LiveMachine& machine() { return machine_; }
  std::uint64_t requests() const { return registers_.requests(); }
  std::string MapText() const {
    std::string text =
        fmt::format("listening on {} port {}\n{}", place_.host, port(), registers_.MapText());
    for (const auto& link : links_) text += fmt::format("  RTU on {}\n", link.string());
    for (const auto& encoders : encoders_) text += encoders->MapText();
    return text;
  }
  std::uint64_t syncs() const {
    std::uint64_t sum = 0;
    for (const auto& encoders : encoders_) sum += encoders->syncs();
    return sum;
  }

 private:
  static std::optional<rig::Course> CourseToRun(const Rig& rig, const RigOptions& options) {
    if (options.course.course.empty()) return {};
    return CourseOf(options.course, rig.world.settings());
  }

  void ServeCan(const Rig& rig, const RigOptions& options) {
    encoders_ = rig::ServeEncoders(machine_, rig.devices, *options.can, clock_);
    if (!encoders_.empty()) return;
    throw InputError(
        fmt::format("--can: {} has no encoders; add a table [devices.NAME] with "
                    "transport = \"canopen\"",
                    options.machine));
  }

  void Start(const RigOptions& options) {
    const bool course = options.start == "course";
    const int program = course ? rig::kCourseProgram : rig::AxisNumber(options.start.front());
    if (machine_.Start(program) == rig::StartOutcome::kStarted) return;
    throw InputError(
        course ? "--start course: no course given; add --course circle or another"
               : fmt::format("--start {}: no sweep of this axis is programmed in {}; add a table "
                             "[sweep.{}]",
                             options.start, options.machine, options.start));
  }

  hal::SteadyClock clock_;
  rig::ServerOptions place_;
  rig::LiveMachine machine_;
  rig::RegisterServer registers_;
  std::vector<std::unique_ptr<rig::EncoderServer>> encoders_;
  std::vector<std::filesystem::path> links_;
};

int Serve(const RigOptions& options) {
  if (options.machine.empty()) {
    throw InputError("rig: --machine FILE is missing, such as --machine machines/demo_mill.toml");
  }
  const auto& interrupted = InterruptFlag();
  const Rig rig(options);
  Served served(rig, options);
  RigHands hands;
  fmt::print("rig of {}, seed {}, {:g} times real time: {}Ctrl-C ends it.\n",
             rig.world.settings().name, options.seed, options.speed, served.MapText());
  std::fflush(stdout);
  if (!options.ready_file.empty()) WriteReadyFile(options.ready_file, served.port());
  while (!interrupted) {
    if (options.hands) hands.Poll(served.machine());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  fmt::print("rig: answered {} requests", served.requests());
  if (options.can) fmt::print(" and {} SYNCs", served.syncs());
  fmt::print("\n");
  return kDone;
}

// Now, or as many days later as the machine is older.
std::string StartOf(const RigOptions& options) {
  constexpr double kSecondsOfDay = 86400.0;
  const auto now = recording::SecondsOf(recording::UtcNow());
  return recording::InstantText(now.value_or(0.0) + options.after_days * kSecondsOfDay);
}

// An interferometer over the whole travel of an axis, the other axes in the middle.
recording::Recording RecordLine(const Rig& rig, char axis, const RigOptions& options) {
  constexpr int kSteps = 12;
  rig::LengthProgram program{.axis = axis,
                             .count = kSteps,
                             .both_ways = options.both_ways,
                             .started = StartOf(options),
                             .sensors = rig.machine.sensors.columns};
  const rig::RigSettings& machine = rig.world.settings();
  for (int i = 0; i < rig::kAxes; ++i) {
    program.at[i] = (machine.travels[i].first + machine.travels[i].last) / 2;
  }
  const auto& [first, last] = machine.travels[rig::AxisNumber(axis)];
  program.step = (last - first) / kSteps;
  return rig::RecordLengths(*rig.linkage, program);
}

recording::Recording Recorded(const Rig& rig, const RigOptions& options) {
  if (!options.axis.empty()) {
    return rig::RecordSweep(
        rig.world, options.axis.front(), rig::ChannelsOf(rig.devices),
        {.rate = options.rate, .mounting = options.mounting, .started = StartOf(options)});
  }
  if (options.plate) {
    return rig::RecordPlate(rig.world,
                            {.run = options.course.run, .both_sides = options.both_ways});
  }
  if (!rig.linkage) {
    throw InputError(
        fmt::format("{} has no linkage to record with; add a table [linkage]", options.machine));
  }
  if (!options.length.empty()) return RecordLine(rig, options.length.front(), options);
  return RecordCourse(*rig.linkage, options.course, options.rate, StartOf(options));
}

int RecordTheCampaign(const RigOptions& options) {
  const Rig rig(options);
  const rig::Campaign campaign = rig::RecordCampaign(
      rig.machine, options.seed, Rig::HiddenOf(rig.machine, options),
      {.kind = CampaignKinds().at(options.campaign), .reduced = options.reduced});
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) {
    throw InputError(fmt::format("--out {}: cannot be made: {}; choose another folder",
                                 options.out.string(), error.message()));
  }
  for (const recording::Recording& recording : campaign.recordings) {
    const std::filesystem::path path = options.out / (recording.name + ".h5");
    recording::Write(recording, path);
    fmt::print("{} ({} rows)\n", path.string(), recording.rows());
  }
  rig.WriteTruth(options, campaign.hidden);
  return kDone;
}

int Record(const RigOptions& options) {
  if (!options.campaign.empty()) return RecordTheCampaign(options);
  const int kinds = (options.axis.empty() ? 0 : 1) + (options.course.course.empty() ? 0 : 1) +
                    (options.length.empty() ? 0 : 1) + (options.plate ? 1 : 0);
  if (kinds != 1) {
    throw InputError(
        "rig record: nothing to record; give a sweep by --axis X, a path of the linkage by "
        "--course circle, calibrated lengths by --length X, a hole plate by --plate, or a whole "
        "--campaign standard");
  }
  recording::Write(Recorded(Rig(options), options), options.out);
  fmt::print("{}\n", options.out.string());
  return kDone;
}

void AddWorldOptions(CLI::App* command, RigOptions& options) {
  command->add_option("--machine", options.machine, "Machine file (TOML)");
  command->add_option("--seed", options.seed, "Seed: the machine drawn from the population")
      ->capture_default_str();
  command->add_option("--truth", options.truth, "Write the truth of the rig (JSON)");
  command->add_option("--hide", options.hide,
                      "A hidden effect, CAUSE:object=OBJECT[:key=value...]; may be repeated "
                      "(docs/virtual-rig.md)");
}

}  // namespace

void AddRig(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<RigOptions>();
  CLI::App* rig = program.add_subcommand("rig", "The virtual rig: a machine that was never built");
  const auto axis = CLI::IsMember({"X", "Y", "Z"});
  AddWorldOptions(rig, *options);
  rig->add_option("--port", options->port,
                  "TCP port, 0 for a free one (default: the machine file's)")
      ->check(CLI::Range(0, 65535));
  rig->add_option("--speed", options->speed, "Simulated seconds per second")
      ->check(CLI::Range(1e-3, 1e4))
      ->capture_default_str();
  rig->add_option("--rtu", options->rtu,
                  "Serve a device over RTU too: DEVICE=LINK to the terminal");
  rig->add_option("--can", options->can,
                  "Serve the linkage's encoders on this CAN interface (default: the machine "
                  "file's)")
      ->expected(0, 1)
      ->default_str("");
  AddCourseOptions(*rig, options->course);
  rig->add_option("--start", options->start, "Sweep this axis, or run the course, at once")
      ->check(CLI::IsMember({"X", "Y", "Z", "course"}));
  rig->add_flag(
      "--hands", options->hands,
      "Move axes and turn screws by lines of standard input: move X 60, turn SCREW -0.35, "
      "head Y");
  rig->add_option("--ready-file", options->ready_file, "Write the port here when listening");
  rig->footer(
      "Example: abbe rig --machine machines/demo_mill.toml --seed 7 --port 1502 --speed 10\n"
      "Example: abbe rig --machine machines/demo_mill.toml --can vcan0 --course circle\n"
      "Example: abbe rig --machine machines/demo_mill.toml --hide probe-gain:object=probe_b");
  rig->callback([rig, options, &exit_code] {
    if (rig->get_subcommands().empty()) exit_code = Serve(*options);
  });

  CLI::App* record =
      rig->add_subcommand("record", "Write the recording of a sweep or a course directly");
  AddWorldOptions(record, *options);
  record->get_option("--machine")->required();
  record->add_option("--axis", options->axis, "Sweep X, Y or Z with the probe head")->check(axis);
  record->add_option("--length", options->length, "Calibrated lengths along X, Y or Z")
      ->check(axis);
  record
      ->add_option("--campaign", options->campaign,
                   "A whole campaign into the folder --out: minimal, standard or full")
      ->check(CLI::IsMember(CampaignKinds()))
      ->excludes("--axis", "--length");
  record->add_flag("--reduced", options->reduced,
                   "Fewer stations, positions and rows in a campaign");
  record->add_flag("--plate", options->plate, "A hole plate in five set-ups");
  record->add_flag("--both-ways", options->both_ways,
                   "Lengths there and back; every second line of holes approached from above");
  record->add_option("--mounting", options->mounting,
                     "Name of the set-up, for the header of a sweep");
  AddCourseOptions(*record, options->course);
  AddRecordingOptions(*record, options->course);
  record->add_option("--out", options->out, "Recording (.csv, .h5), or the campaign's folder")
      ->required();
  record->add_option("--rate", options->rate, "Rows per second")->capture_default_str();
  record->add_option("--after-days", options->after_days,
                     "So many days later: the machine has aged by [rig.ageing]");
  record->footer(
      "Example: abbe rig record --machine machines/demo_mill.toml --axis X --out x.csv\n"
      "Example: abbe rig record --machine machines/demo_mill.toml --course circle --reference "
      "--out circle.csv\n"
      "Example: abbe rig record --machine machines/demo_mill.toml --seed 7 --campaign standard "
      "--hide backlash:object=X:width_um=6 --truth truth.json --out campaign");
  record->callback([options, &exit_code] { exit_code = Record(*options); });

  CLI::App* compare = rig->add_subcommand("compare", "Compares results with the truth");
  compare->add_option("truth", options->truth_to_compare, "File of --truth")->required();
  compare->add_option("results", options->results, "JSON of sweeps or of a diagnosis")->required();
  compare->footer("Example: abbe rig compare out/rig_truth.json out/sweep_X.json");
  compare->callback([options, &exit_code] {
    exit_code = CompareWithTruth(options->truth_to_compare, options->results);
  });
}

}  // namespace abbe::apps
