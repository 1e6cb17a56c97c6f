// abbe reduce: results from recordings.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/causes_option.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/doubted_sweep.h"
#include "apps/machine_file.h"
#include "apps/machine_recording.h"
#include "apps/protocol.h"
#include "apps/reduce_reference.h"
#include "apps/reduce_sweep.h"
#include "apps/result_file.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

struct ReduceOptions {
  std::vector<fs::path> recordings;
  fs::path machine, out, json;
  CausesOption causes;
  bool squareness = false;
  bool quiet = false;
};

class Reduction {
 public:
  explicit Reduction(const ReduceOptions& options) : options_(options) {}

  int Run() {
    if (!options_.json.empty() && options_.recordings.size() > 1) {
      throw InputError("--json takes the result of one recording; use --out for several");
    }
    if (!options_.causes.path.empty()) Setup();
    for (const fs::path& path : options_.recordings) {
      const recording::Recording recording = ReadWithWarnings(path);
      Reduce(recording, path);
    }
    if (options_.squareness) Squareness();
    if (causes_ && causes_->Active()) Show(causes_->Line() + "\n");
    return kDone;
  }

 private:
  void Reduce(const recording::Recording& recording, const fs::path& path) {
    using Step = nlohmann::ordered_json (Reduction::*)(const recording::Recording&);
    static const std::map<std::string, Step> steps{{"sweep", &Reduction::Sweep},
                                                   {"reference", &Reduction::Reference}};
    const auto step = steps.find(recording.Kind());
    if (step == steps.end()) {
      throw InputError(
          fmt::format("{}: kind is \"{}\"; reduce takes recordings of kind sweep or reference",
                      path.string(), recording.Kind()));
    }
    nlohmann::ordered_json result = (this->*step->second)(recording);
    AddProtocol(recording, result);
    Keep(result, path.stem().string());
  }

  nlohmann::ordered_json Sweep(const recording::Recording& recording) {
    const probes::SweepSetup& setup = Setup();
    sweeps_.push_back(ReduceCorrected(recording, setup, *causes_));
    Show(SweepTable(sweeps_.back()));
    auto json = SweepJson(sweeps_.back());
    if (causes_->Active()) json["causes_taken_out"] = causes_->Data();
    return json;
  }

  nlohmann::ordered_json Reference(const recording::Recording& recording) {
    nlohmann::ordered_json result = ReduceReference(recording);
    Show(ReferenceTable(result));
    return result;
  }

  void Squareness() {
    if (sweeps_.size() != 2) {
      throw InputError(
          fmt::format("--squareness compares two sweeps, {} given; name the sweeps of two axes",
                      sweeps_.size()));
    }
    const auto result = probes::SquarenessOfSweeps(sweeps_[0], sweeps_[1], Setup().target);
    Show(SquarenessLine(result));
    Keep(SquarenessJson(result), "squareness_" + result.name);
  }

  const probes::SweepSetup& Setup() {
    if (!file_) {
      if (options_.machine.empty()) {
        throw InputError("a sweep and an extended model need the machine file; add --machine FILE");
      }
      file_ = ReadMachineFile(options_.machine);
      causes_.emplace(options_.causes, *file_, kForMaps);
    }
    return file_->sweep_setup;
  }

  void Show(const std::string& text) const {
    if (!options_.quiet) fmt::print("{}", text);
  }

  void Keep(const nlohmann::ordered_json& result, const std::string& name) const {
    if (!options_.json.empty()) WriteResult(result, options_.json);
    if (!options_.out.empty()) WriteResult(result, options_.out / (name + ".json"));
  }

  const ReduceOptions& options_;
  std::optional<MachineFile> file_;
  std::optional<CauseCorrection> causes_;
  std::vector<probes::SweepResult> sweeps_;
};

}  // namespace

void AddReduce(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<ReduceOptions>();
  CLI::App* command =
      program.add_subcommand("reduce", "From recordings to errors with uncertainty");
  command->add_option("recordings", options->recordings, "Recordings of kind sweep or reference")
      ->required();
  command->add_option("--machine", options->machine, "Machine file; sweeps need it");
  AddCausesOption(*command, options->causes);
  command->add_option("--out", options->out, "Folder for one result (RECORDING.json) each");
  command->add_option("--json", options->json, "File for the result of one recording");
  command->add_flag("--squareness", options->squareness, "Squareness of two sweeps, one mounting");
  command->add_flag("--quiet", options->quiet, "No table");
  command->footer("Example: abbe reduce sweep_X.csv --machine mill.toml --out measured");
  command->callback([options, &exit_code] { exit_code = Reduction(*options).Run(); });
}

}  // namespace abbe::apps
