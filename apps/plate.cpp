// abbe plate: the 21 errors of the machine from recordings of a hole plate.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/evaluate_plate.h"
#include "apps/machine_file.h"
#include "apps/machine_recording.h"
#include "apps/output_guard.h"
#include "apps/plate_result.h"
#include "apps/protocol.h"
#include "apps/result_file.h"
#include "apps/working_line.h"
#include "map/map_file.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

struct PlateArguments {
  std::vector<fs::path> recordings;
  fs::path machine, out = "map.toml", json, specimen;
  int holdout = 0;
  bool network = false, fixed_smoothness = false, quiet = false;
};

// Adds whose measurements they are to `result`.
std::vector<simulation::PlateSetup> ReadSetups(const PlateArguments& arguments,
                                               const machine::Machine& machine,
                                               nlohmann::ordered_json& result) {
  RefuseTwice(arguments.recordings);
  std::vector<simulation::PlateSetup> setups;
  for (const fs::path& path : arguments.recordings) {
    const recording::Recording recording = ReadRecordingOf(machine, path);
    AddProtocol(recording, result);
    for (auto& setup : simulation::ReadPlate(recording)) setups.push_back(std::move(setup));
  }
  RefuseNearCopies(arguments.recordings);
  return setups;
}

// The same machine with the networks of the paper, which have no uncertainty.
map::ErrorMap WithNetworks(const map::ErrorMap& map,
                           const std::vector<simulation::PlateSetup>& setups) {
  return {map.origin(),
          fusion::AsNetworks(map.model(), fusion::StationsOf(setups),
                             machine::NetworkBias::kWithBias, nullptr),
          {}};
}

int Plate(const PlateArguments& arguments) {
  RefuseUnwritable(arguments.out);
  const machine::Machine machine = ReadMachineOf(arguments.machine);
  nlohmann::ordered_json whose = nlohmann::ordered_json::object();
  const auto setups = ReadSetups(arguments, machine, whose);
  PlateOptions options{.fixed_smoothness = arguments.fixed_smoothness,
                       .holdout = arguments.holdout};
  if (!arguments.specimen.empty()) options.specimen = ReadRecordingOf(machine, arguments.specimen);
  const PlateResult result = [&] {
    const WorkingLine line("plate", arguments.quiet);
    return EvaluatePlate(machine, setups, options);
  }();
  const fusion::FuseReport& fused = result.fused;
  map::WriteMap(arguments.network ? WithNetworks(fused.map, setups) : fused.map, arguments.out);
  if (!arguments.json.empty()) {
    auto json = PlateJson(result);
    json.update(whose);
    WriteResult(json, arguments.json);
  }
  if (!arguments.quiet) fmt::print("{}\nmap: {}\n", PlateTable(result), arguments.out.string());
  return kDone;
}

}  // namespace

void AddPlate(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<PlateArguments>();
  CLI::App* command = program.add_subcommand("plate", "The 21 errors of a machine by a hole plate");
  command->add_option("recordings", arguments->recordings, "Recordings of kind plate")->required();
  command->add_option("--machine", arguments->machine, "Machine file")->required();
  command
      ->add_option("--holdout", arguments->holdout,
                   "Leave out every K-th hole in turn and compare the predictions of it")
      ->check(CLI::Range(2, 100));
  command->add_option("--specimen", arguments->specimen,
                      "Recording of kind length: measured before and after correction");
  command->add_flag("--network", arguments->network,
                    "Write the error functions as networks, without uncertainty");
  command->add_flag("--fixed-smoothness", arguments->fixed_smoothness,
                    "Keep [population], the noise and the form of the machine file");
  command->add_option("-o,--out", arguments->out, "Error map (TOML)");
  command->add_option("--json", arguments->json, "File for the result as data");
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer("Example: abbe plate plate.csv --machine mill.toml --holdout 4 -o map.toml");
  command->callback([arguments, &exit_code] { exit_code = Plate(*arguments); });
}

}  // namespace abbe::apps
