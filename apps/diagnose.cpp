// abbe diagnose: finds the causes of the residuals of a simulation.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/campaign_kinds.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/diagnose_plan.h"
#include "apps/diagnosis_result.h"
#include "apps/instruments.h"
#include "apps/learned_result.h"
#include "apps/machine_recording.h"
#include "apps/protocol.h"
#include "apps/result_file.h"
#include "apps/working_line.h"
#include "failure/failure.h"
#include "learned/carried.h"
#include "learned/explain.h"
#include "settings/toml_text.h"
#include "simulation/doubt.h"
#include "simulation/kinds.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

struct DiagnoseArguments {
  std::vector<fs::path> recordings, learned;
  fs::path machine, out, json;
  std::string campaign;  // of the plan
  bool plan = false, learn = false, verbose = false, quiet = false;
};

void WriteModel(const simulation::ExtendedModel& model, const DiagnoseArguments& arguments) {
  WriteText(ModelText(model, arguments.recordings), arguments.out);
  if (!simulation::IsUnexplained(model)) return;
  fmt::print(stderr,
             "abbe: {}: other commands will refuse it, because something is left unexplained, "
             "unless --although-unexplained is given\n",
             arguments.out.string());
}

nlohmann::ordered_json JsonOf(const DiagnoseArguments& arguments,
                              const std::vector<recording::Recording>& recordings,
                              const learned::Explanation& all) {
  auto json = DiagnosisJson(all.diagnosis, all.gain);
  AddLearned(all.learning, json);
  json["abbe"] = ABBE_VERSION;
  json["machine"] = all.campaign->instruments().machine.name;
  for (const fs::path& path : arguments.recordings) {
    json["recordings"].push_back(path.filename().string());
  }
  for (const auto& recording : recordings) AddProtocol(recording, json);
  json["notes"] = all.Notes();
  if (!arguments.out.empty()) json["model"] = arguments.out.filename().string();
  return json;
}

void Print(const learned::Explanation& all, bool verbose) {
  fmt::print("{}{}", DiagnosisText(all.diagnosis, all.gain, verbose), LearnedText(all.learning));
  for (const std::string& note : all.Notes()) fmt::print("\nNote: {}\n", note);
  std::fflush(stdout);
}

int Diagnose(const DiagnoseArguments& arguments) {
  if (arguments.plan) {
    return DiagnosePlan({arguments.recordings, arguments.campaign, arguments.machine,
                         arguments.json, arguments.quiet});
  }
  if (arguments.recordings.empty()) {
    throw InputError("diagnose: no recording is given; name at least one, or plan with --plan");
  }
  RefuseTwice(arguments.recordings);
  simulation::Instruments instruments = ReadInstruments(arguments.machine);
  std::vector<recording::Recording> recordings;
  for (const fs::path& path : arguments.recordings) recordings.push_back(ReadWithWarnings(path));
  RefuseNearCopies(arguments.recordings);
  const learned::Explanation all = [&] {
    const WorkingLine line("diagnose", arguments.quiet);
    return learned::Explain(recordings, std::move(instruments),
                            {arguments.learn, learned::CarriedFrom(arguments.learned)});
  }();
  if (all.why_no_gain) fmt::print(stderr, "abbe: {}\n", *all.why_no_gain);
  // First, so that it is not lost where a file cannot be written.
  if (!arguments.quiet) Print(all, arguments.verbose);
  if (!arguments.out.empty()) WriteModel(learned::ModelOf(all), arguments);
  if (!arguments.json.empty()) WriteResult(JsonOf(arguments, recordings, all), arguments.json);
  return kDone;
}

}  // namespace

void AddDiagnose(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<DiagnoseArguments>();
  CLI::App* command = program.add_subcommand(
      "diagnose", "Finds the causes of what the simulation of the runs does not explain");
  command->add_option("recordings", arguments->recordings,
                      fmt::format("Recordings of one machine: {}", simulation::KindNames()));
  command->add_option("--machine", arguments->machine, "Machine file")->required();
  auto* out = command->add_option(
      "-o,--out", arguments->out,
      "Extended model (TOML) with the causes found, for --causes of other commands");
  command->add_option("--json", arguments->json, "File for the result as data");
  auto* plan = command->add_flag("--plan", arguments->plan,
                                 "Before measuring: the causes that runs on the paths of these "
                                 "recordings would show, and from which size on");
  command
      ->add_option(
          "--campaign", arguments->campaign,
          "With --plan: the runs of a campaign of the virtual rig: minimal, standard, full")
      ->check(CLI::IsMember(CampaignKinds()))
      ->needs(plan);
  command
      ->add_flag("--learn", arguments->learn,
                 "Where something is left, extend the simulation by terms that nobody wrote down; "
                 "on trial: how often one is wrong has not been measured yet")
      ->excludes(plan);
  command
      ->add_option("--learned", arguments->learned,
                   "Extended models of other machines: the terms that were learned there compete "
                   "as named causes")
      ->excludes(plan);
  command
      ->add_flag(
          "--verbose", arguments->verbose,
          "A line for each channel and run that is left unexplained, also where they are alike")
      ->excludes(plan);
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer(
      "Example: abbe diagnose sweep_X.csv circle.csv cube.csv --machine mill.toml -o "
      "mill.causes.toml\n"
      "         abbe diagnose --plan --campaign standard --machine mill.toml");
  plan->excludes(out);
  command->callback([arguments, &exit_code] { exit_code = Diagnose(*arguments); });
}

}  // namespace abbe::apps
