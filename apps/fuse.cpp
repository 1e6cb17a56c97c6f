// abbe fuse: one error map from all recordings of a machine.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/causes_option.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/conditions.h"
#include "apps/fuse_result.h"
#include "apps/instruments.h"
#include "apps/machine_recording.h"
#include "apps/output_guard.h"
#include "apps/protocol.h"
#include "apps/result_file.h"
#include "apps/working_line.h"
#include "fusion/fuse_sources.h"
#include "map/map_file.h"
#include "map/map_grid.h"
#include "simulation/kinds.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using simulation::RunSource;

struct FuseArguments {
  std::vector<fs::path> recordings;
  fs::path machine, out = "map.toml", json;
  CausesOption causes;
  int holdout = 0;
  bool fixed_smoothness = false, quiet = false;
};

struct MapChange {
  double rms, largest;  // m
};

// Rms and largest change over a grid of the volume.
MapChange ChangeOf(const map::ErrorMap& before, const map::ErrorMap& after) {
  const Eigen::Vector3d& tool = after.origin().tool;
  const std::array<Eigen::Index, 3> points{11, 11, 11};
  const Eigen::RowVectorXd change = (map::SampleErrors(after, tool, points).error() -
                                     map::SampleErrors(before, tool, points).error())
                                        .colwise()
                                        .norm();
  return {std::sqrt(change.squaredNorm() / change.size()), change.maxCoeff()};
}

// Recordings as they were read, causes and all, may fit no map.
std::optional<fusion::FuseReport> FuseIfItFits(const simulation::Instruments& instruments,
                                               const std::vector<RunSource>& sources,
                                               const fusion::AsTaken& as_taken,
                                               bool choose_smoothness) {
  try {
    return fusion::FuseSources(sources, instruments, {.choose_smoothness = choose_smoothness},
                               as_taken);
  } catch (const NumericalError&) {
    return std::nullopt;
  }
}

// What a map has to be doubted for: without the causes that are not certain it would be `other`.
fusion::Doubt DoubtOf(const CauseCorrection& causes,
                      const std::optional<fusion::FuseReport>& other) {
  if (!causes.WidensU95()) return {};
  if (!other) {
    throw NumericalError(
        "without the causes that are not certain no map fits the recordings, so no U95 can be "
        "stated; diagnose until they are certain");
  }
  return {&other->map, causes.unexplained()};
}

// The causes that the map does not contain, one line each.
std::string NotInMap(const std::vector<simulation::ModelledCause>& causes) {
  std::string text;
  for (const auto& cause : causes) {
    if (cause.cause->CorrectedAt(cause.object) != simulation::CorrectedBy::kMotion) continue;
    text += fmt::format("not in the map: {}", cause.Name());
    for (std::size_t i = 0; i < cause.cause->keys.size(); ++i) {
      const auto& key = cause.cause->keys[i];
      text += fmt::format(", {} = {:.4g}", key.name, cause.values[i] / key.unit);
    }
    text += '\n';
  }
  return text;
}

int Fuse(const FuseArguments& arguments) {
  RefuseUnwritable(arguments.out);
  RefuseTwice(arguments.recordings);
  const MachineFile file = ReadMachineFile(arguments.machine);
  const machine::Machine& machine = file.sweep_setup.machine;
  if (machine.population.squareness == 0.0) {
    throw file.document.Root()
        .Child("population")
        .Error("squareness_urad",
               "must be above 0: a map estimates it; state how well it is known");
  }
  CauseCorrection causes(arguments.causes, file, kForMaps);
  const simulation::Instruments instruments = InstrumentsOf(file);
  std::vector<RunSource> sources;
  for (const fs::path& path : arguments.recordings) sources.push_back(SourceAt(machine, path));
  simulation::RefuseStrangers(sources, instruments);
  RefuseNearCopies(arguments.recordings);
  std::optional<WorkingLine> line(std::in_place, "fuse", arguments.quiet);
  const bool choose = !arguments.fixed_smoothness;
  std::optional<fusion::FuseReport> other;
  if (causes.WidensU95()) {
    const auto certain = [&](const RunSource& source) {
      return simulation::SourceOf(causes.TakeCertain(source.whole()));
    };
    other = FuseIfItFits(instruments, sources, certain, choose);
  }
  const auto corrected = [&](const RunSource& source) {
    return simulation::SourceOf(causes.Take(source.whole()));
  };
  const track::Conditions conditions = MeanConditions(sources);
  fusion::FuseOptions options{.choose_smoothness = choose,
                              .holdout = arguments.holdout,
                              .doubt = DoubtOf(causes, other),
                              .measured = conditions.time};
  for (const auto& [sensor, mean] : conditions.temperature) {
    options.sensors.push_back({sensor, 0.0, mean, mean});
  }
  const fusion::FuseReport report =
      fusion::FuseSources(sources, instruments, options,
                          causes.Active() ? fusion::AsTaken(corrected) : fusion::AsTaken());
  auto json = FuseJson(report);
  for (const RunSource& source : sources) AddProtocol(source.head, json);
  std::string text = FuseTable(report);
  if (causes.Active()) {
    json["causes_taken_out"] = causes.Data();
    text += fmt::format("\n{}\n{}", causes.Line(), NotInMap(causes.taken()));
    const auto without =
        other && !causes.TakesCertain() ? other : FuseIfItFits(instruments, sources, {}, choose);
    if (without) {
      const MapChange change = ChangeOf(without->map, report.map);
      json["map_change_um"] = {{"rms", 1e6 * change.rms}, {"largest", 1e6 * change.largest}};
      text += fmt::format("without them the map would differ by {:.2f} um rms, {:.2f} um at most\n",
                          1e6 * change.rms, 1e6 * change.largest);
    } else {
      text += "without them no map fits the recordings\n";
    }
  }
  line.reset();
  // First, so that it is not lost where a file cannot be written.
  if (!arguments.quiet) fmt::print("{}\n", text);
  map::WriteMap(report.map, arguments.out);
  if (!arguments.quiet) fmt::print("map: {}\n", arguments.out.string());
  if (!arguments.json.empty()) WriteResult(json, arguments.json);
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
                    "Keep [population], the noise and the form of the machine file");
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
