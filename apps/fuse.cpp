// abbe fuse: one error map from all recordings of a machine.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/causes_option.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/fuse_result.h"
#include "apps/machine_file.h"
#include "apps/machine_recording.h"
#include "apps/result_file.h"
#include "map/map_file.h"
#include "map/map_grid.h"
#include "simulation/linkage/linkage_on_machine.h"
#include "simulation/linkage/linkage_parts.h"
#include "simulation/linkage/one_ball.h"
#include "simulation/points/length_simulation.h"
#include "simulation/points/plate_simulation.h"
#include "simulation/points/reference_simulation.h"
#include "simulation/sweep/sweep_simulation.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using simulation::SimulatedRun;

struct FuseArguments {
  std::vector<fs::path> recordings;
  fs::path machine, causes, out = "map.toml", json;
  int holdout = 0;
  bool fixed_smoothness = false, quiet = false;
};

// A recording, block by block or as a whole.
struct Source {
  recording::Recording head;
  recording::Blocks blocks;
  std::function<recording::Recording()> whole;
};

Source SourceAt(const machine::Machine& machine, const fs::path& path) {
  return {ReadHeadOf(machine, path), BlocksOf(path),
          [&machine, path] { return ReadRecordingOf(machine, path); }};
}

Source SourceOf(recording::Recording recording) {
  const auto shared = std::make_shared<const recording::Recording>(std::move(recording));
  return {*shared, [shared](const auto& use) { use(*shared); }, [shared] { return *shared; }};
}

// Reads every recording and simulates it according to its kind.
class RunReader {
 public:
  explicit RunReader(const MachineFile& file)
      : file_(file), machine_(file.sweep_setup.machine), model_(fusion::UnknownMachine(machine_)) {}

  void Add(const Source& source, std::vector<SimulatedRun>& runs) {
    const std::string kind = source.head.Kind();
    if (kind == "sweep") {
      AddSweep(source, runs);
    } else if (kind == "linkage") {
      AddLinkage(source, runs);
    } else if (kind == "reference") {
      AddReference(source, runs);
    } else if (kind == "length") {
      runs.push_back(simulation::SimulateLengths(model_, machine_.reference, source.whole()));
    } else if (kind == "plate") {
      for (const auto& setup : simulation::ReadPlate(source.whole())) {
        runs.push_back(simulation::SimulatePlate(model_, machine_.reference, setup));
      }
    } else {
      throw InputError(
          fmt::format("{}: kind is \"{}\"; fuse takes sweep, linkage, reference, length and plate",
                      source.head.name, kind));
    }
  }

 private:
  void AddSweep(const Source& source, std::vector<SimulatedRun>& runs) const {
    const auto& setup = file_.sweep_setup;
    runs.push_back(simulation::SimulateSweep(
        model_, machine_.reference, {setup.head, setup.target},
        simulation::ReadSweepRun(source.head, source.blocks, setup.head, setup.noise)));
  }

  void AddLinkage(const Source& source, std::vector<SimulatedRun>& runs) {
    const relm::LinkageSettings& linkage = file_.Linkage();
    const simulation::LinkageSimulation nominal(
        machine_.chain, linkage, relm::MakeLinkageModel(linkage, relm::ErrorModel::kComplete));
    const auto parts = simulation::PartsOf(source.blocks, linkage);
    RefuseOtherBall(source.head, parts);
    runs.push_back(simulation::SimulateLinkage(model_, machine_.reference, nominal, parts));
    if (source.head.Find("ref_x_mm") || source.head.Find("ref_y_mm") ||
        source.head.Find("ref_z_mm")) {
      AddReference(source, runs);
    }
  }

  // InputError unless all linkage runs have one ball, compared by samples; a single run is not
  // read.
  void RefuseOtherBall(const recording::Recording& head, const simulation::LinkageParts& parts) {
    constexpr Eigen::Index kMost = 4096, kSample = 1024;
    linkages_.emplace_back(recording::Recording{head.name, head.header, {}, {}}, parts);
    for (; linkages_.size() > 1 && compared_ < linkages_.size(); ++compared_) {
      const auto& [of, its_parts] = linkages_[compared_];
      ball_.Add(of, simulation::SampleOf(its_parts, kMost, kSample).run);
    }
  }

  void AddReference(const Source& source, std::vector<SimulatedRun>& runs) const {
    runs.push_back(simulation::SimulateReference(model_, machine_.reference,
                                                 file_.Linkage().noise.reference, source.whole()));
  }

  const MachineFile& file_;
  const machine::Machine& machine_;
  machine::VolumetricModel model_;
  std::vector<std::pair<recording::Recording, simulation::LinkageParts>> linkages_;
  std::size_t compared_ = 0;  // of linkages_
  simulation::OneBall ball_;
};

struct MapChange {
  double rms, largest;  // m
};

// Rms and largest change over a grid of the volume.
MapChange ChangeOf(const map::ErrorMap& before, const map::ErrorMap& after) {
  const Eigen::Vector3d& tool = after.origin().tool;
  const std::array<Eigen::Index, 3> points{11, 11, 11};
  const Eigen::RowVectorXd change =
      (map::SampleGrid(after, tool, points).error() - map::SampleGrid(before, tool, points).error())
          .colwise()
          .norm();
  return {std::sqrt(change.squaredNorm() / static_cast<double>(change.size())), change.maxCoeff()};
}

// Nothing when no map fits, which uncorrected recordings may cause.
std::optional<fusion::FuseReport> FuseIfItFits(const machine::Machine& machine,
                                               const std::vector<SimulatedRun>& runs,
                                               bool choose_smoothness) {
  try {
    return fusion::Fuse(machine, runs, {.choose_smoothness = choose_smoothness});
  } catch (const NumericalError&) {
    return std::nullopt;
  }
}

// The causes that the map does not contain, one line each.
std::string NotInMap(const std::vector<simulation::ModelledCause>& causes) {
  std::string text;
  for (const auto& cause : causes) {
    if (cause.cause->SeatAt(cause.object) != simulation::Seat::kMotion) continue;
    text += fmt::format("not in the map: {}", cause.Name());
    for (std::size_t i = 0; i < cause.cause->keys.size(); ++i) {
      const auto& key = cause.cause->keys[i];
      text += fmt::format(", {} = {:.4g}", key.name,
                          cause.values[static_cast<Eigen::Index>(i)] / key.unit);
    }
    text += '\n';
  }
  return text;
}

// A recording given twice would count twice.
void RefuseTwice(const std::vector<fs::path>& recordings) {
  std::set<fs::path> seen;
  for (const fs::path& path : recordings) {
    if (seen.insert(fs::weakly_canonical(path)).second) continue;
    throw InputError(fmt::format("{}: is given twice, and its rows would count twice; give it once",
                                 path.string()));
  }
}

int Fuse(const FuseArguments& arguments) {
  RefuseTwice(arguments.recordings);
  const MachineFile file = ReadMachineFile(arguments.machine);
  const machine::Machine& machine = file.sweep_setup.machine;
  CauseCorrection causes(arguments.causes, file, kForMaps);
  RunReader reader(file);
  std::vector<SimulatedRun> runs, as_read;
  for (const fs::path& path : arguments.recordings) {
    const Source source = SourceAt(machine, path);
    if (!causes.Active()) {
      reader.Add(source, runs);
      continue;
    }
    reader.Add(SourceOf(causes.Take(source.whole())), runs);
    reader.Add(source, as_read);
  }
  const fusion::FuseReport report = fusion::Fuse(
      machine, runs,
      {.choose_smoothness = !arguments.fixed_smoothness, .holdout = arguments.holdout});
  map::WriteMap(report.map, arguments.out);
  auto json = FuseJson(report, runs);
  std::string text = FuseTable(report, runs);
  if (causes.Active()) {
    json["causes_taken_out"] = causes.Data();
    text += fmt::format("\n{}\n{}", causes.Line(), NotInMap(causes.taken()));
    if (const auto without = FuseIfItFits(machine, as_read, !arguments.fixed_smoothness)) {
      const MapChange change = ChangeOf(without->map, report.map);
      json["map_change_um"] = {{"rms", 1e6 * change.rms}, {"largest", 1e6 * change.largest}};
      text += fmt::format("without them the map would differ by {:.2f} um rms, {:.2f} um at most\n",
                          1e6 * change.rms, 1e6 * change.largest);
    } else {
      text += "without them no map fits the recordings\n";
    }
  }
  if (!arguments.json.empty()) WriteResult(json, arguments.json);
  if (!arguments.quiet) fmt::print("{}\nmap: {}\n", text, arguments.out.string());
  return kDone;
}

}  // namespace

void AddFuse(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<FuseArguments>();
  CLI::App* command =
      program.add_subcommand("fuse", "One error map of the machine from all recordings");
  command
      ->add_option("recordings", arguments->recordings,
                   "Recordings of kind sweep, linkage, reference, length or plate")
      ->required();
  command->add_option("--machine", arguments->machine, "Machine file")->required();
  AddCausesOption(*command, arguments->causes);
  command->add_flag("--fixed-smoothness", arguments->fixed_smoothness,
                    "Keep population.smoothness_mm of the machine file");
  command->add_option(
      "--holdout", arguments->holdout,
      "Fit once more without every n-th block of rows of each run and predict them");
  command->add_option("-o,--out", arguments->out, "Error map (TOML)");
  command->add_option("--json", arguments->json, "File for the result as data");
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer(
      "Example: abbe fuse sweep_X.csv sweep_Y.csv sweep_Z.csv volume.csv line_X.csv --machine "
      "mill.toml -o map.toml");
  command->callback([arguments, &exit_code] { exit_code = Fuse(*arguments); });
}

}  // namespace abbe::apps
