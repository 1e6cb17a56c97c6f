// abbe fuse: from all recordings of a machine to one error map.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/fuse_result.h"
#include "apps/machine_file.h"
#include "apps/machine_recording.h"
#include "apps/result_file.h"
#include "map/map_file.h"
#include "simulation/length_simulation.h"
#include "simulation/linkage_on_machine.h"
#include "simulation/plate_simulation.h"
#include "simulation/reference_simulation.h"
#include "simulation/sweep_simulation.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using simulation::SimulatedRun;

struct FuseArguments {
  std::vector<fs::path> recordings;
  fs::path machine, out = "map.toml", json;
  int holdout = 0;
  bool fixed_smoothness = false, quiet = false;
};

// Every recording with the simulation of its kind.
class RunReader {
 public:
  explicit RunReader(const MachineFile& file)
      : file_(file), machine_(file.sweep_setup.machine), model_(fusion::UnknownMachine(machine_)) {}

  void Add(const fs::path& path, std::vector<SimulatedRun>& runs) const {
    const recording::Recording recording = ReadRecordingOf(machine_, path);
    const std::string kind = recording.Kind();
    if (kind == "sweep") {
      const auto& setup = file_.sweep_setup;
      runs.push_back(
          simulation::SimulateSweep(model_, machine_.reference, {setup.head, setup.target},
                                    simulation::ReadSweepRun(recording, setup.head, setup.noise)));
    } else if (kind == "linkage") {
      AddLinkage(recording, runs);
    } else if (kind == "reference") {
      AddReference(recording, runs);
    } else if (kind == "length") {
      runs.push_back(simulation::SimulateLengths(model_, machine_.reference, recording));
    } else if (kind == "plate") {
      for (const auto& setup : simulation::ReadPlate(recording)) {
        runs.push_back(simulation::SimulatePlate(model_, machine_.reference, setup));
      }
    } else {
      throw InputError(
          fmt::format("{}: kind is \"{}\"; fuse takes sweep, linkage, reference, length and plate",
                      recording.name, kind));
    }
  }

 private:
  void AddLinkage(const recording::Recording& recording, std::vector<SimulatedRun>& runs) const {
    const relm::LinkageSettings& linkage = file_.Linkage();
    const simulation::LinkageSimulation nominal(
        machine_.chain, linkage, relm::MakeLinkageModel(linkage, relm::ErrorModel::kComplete));
    runs.push_back(simulation::SimulateLinkage(
        model_, machine_.reference, nominal,
        simulation::MeansOfStays(simulation::ReadLinkageRun(recording, linkage))));
    if (recording.Find("ref_x_mm") || recording.Find("ref_y_mm") || recording.Find("ref_z_mm")) {
      AddReference(recording, runs);
    }
  }

  void AddReference(const recording::Recording& recording, std::vector<SimulatedRun>& runs) const {
    runs.push_back(simulation::SimulateReference(model_, machine_.reference,
                                                 file_.Linkage().noise.reference, recording));
  }

  const MachineFile& file_;
  const machine::Machine& machine_;
  machine::VolumetricModel model_;
};

int Fuse(const FuseArguments& arguments) {
  const MachineFile file = ReadMachineFile(arguments.machine);
  const RunReader reader(file);
  std::vector<SimulatedRun> runs;
  for (const fs::path& path : arguments.recordings) reader.Add(path, runs);
  const fusion::FuseReport report = fusion::Fuse(
      file.sweep_setup.machine, runs,
      {.choose_smoothness = !arguments.fixed_smoothness, .holdout = arguments.holdout});
  map::WriteMap(report.map, arguments.out);
  if (!arguments.json.empty()) WriteResult(FuseJson(report, runs), arguments.json);
  if (!arguments.quiet) {
    fmt::print("{}\nmap: {}\n", FuseTable(report, runs), arguments.out.string());
  }
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
