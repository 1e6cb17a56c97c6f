// abbe diagnose: finds the causes of the residuals of a simulation.
#include <fmt/format.h>

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
#include "diagnosis/doubts.h"
#include "diagnosis/found_model.h"
#include "diagnosis/measured_noise.h"
#include "diagnosis/next_run.h"
#include "failure/failure.h"
#include "learned/carried.h"
#include "learned/learning.h"
#include "recording/file_hash.h"
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
  bool plan = false, learn = false, quiet = false;
};

void WriteModel(simulation::ExtendedModel model, const DiagnoseArguments& arguments) {
  for (const fs::path& path : arguments.recordings) {
    model.sources.push_back({path.filename().string(), recording::Sha256OfFile(path)});
  }
  WriteText(simulation::ExtendedModelText(model), arguments.out);
  if (!simulation::IsUnexplained(model)) return;
  fmt::print(stderr,
             "abbe: {}: other commands will refuse it, because something is left unexplained, "
             "unless --although-unexplained is given\n",
             arguments.out.string());
}

nlohmann::ordered_json JsonOf(const DiagnoseArguments& arguments,
                              const std::vector<recording::Recording>& recordings,
                              const diagnosis::Campaign& campaign,
                              const diagnosis::Diagnosis& diagnosis,
                              const diagnosis::HeldOutGain& gain,
                              const learned::Learning& learning) {
  auto json = DiagnosisJson(diagnosis, gain);
  AddLearned(learning, json);
  json["abbe"] = ABBE_VERSION;
  json["machine"] = campaign.instruments().machine.name;
  for (const fs::path& path : arguments.recordings) {
    json["recordings"].push_back(path.filename().string());
  }
  for (const auto& recording : recordings) AddProtocol(recording, json);
  json["notes"] = campaign.notes();
  for (const std::string& note : diagnosis.notes) json["notes"].push_back(note);
  if (!arguments.out.empty()) json["model"] = arguments.out.filename().string();
  return json;
}

diagnosis::HeldOutGain GainOf(const diagnosis::Campaign& campaign,
                              const std::vector<recording::Recording>& recordings,
                              const std::vector<diagnosis::Candidate>& causes) {
  std::string why_not;
  auto gain = diagnosis::HoldOutWhereTheySuffice(campaign, recordings, causes, why_not);
  if (!why_not.empty()) fmt::print(stderr, "abbe: {}\n", why_not);
  return gain;
}

void RefuseStrangers(const std::vector<recording::Recording>& recordings,
                     const simulation::Instruments& instruments) {
  std::vector<simulation::RunSource> sources;
  sources.reserve(recordings.size());
  for (const recording::Recording& each : recordings) sources.push_back(simulation::SourceOf(each));
  simulation::RefuseStrangers(sources, instruments);
}

int Diagnose(const DiagnoseArguments& arguments) {
  if (arguments.plan) {
    return DiagnosePlan({arguments.recordings, arguments.campaign, arguments.machine,
                         arguments.json, arguments.quiet});
  }
  if (arguments.recordings.empty()) {
    throw InputError("diagnose: no recording is given; name at least one, or plan with --plan");
  }
  std::vector<recording::Recording> recordings;
  for (const fs::path& path : arguments.recordings) recordings.push_back(ReadWithWarnings(path));
  simulation::Instruments instruments = ReadInstruments(arguments.machine);
  RefuseStrangers(recordings, instruments);
  diagnosis::UseMeasuredNoise(recordings, instruments);
  diagnosis::Campaign campaign(std::move(instruments));
  for (const recording::Recording& recording : recordings) campaign.Add(recording);
  campaign.CarryOn(learned::CarriedFrom(arguments.learned));
  diagnosis::Diagnosis diagnosis = diagnosis::Diagnose(campaign);
  const diagnosis::Campaign& found = diagnosis::CampaignOf(diagnosis, campaign);
  diagnosis::AddNextRuns(found, recordings, diagnosis);
  std::vector<diagnosis::Candidate> causes;
  for (const auto& finding : diagnosis.findings) {
    if (diagnosis::IsModelled(finding)) causes.push_back(finding.score.candidate);
  }
  learned::Learning learning;
  if (arguments.learn) learning = learned::Learn(diagnosis);
  const diagnosis::HeldOutGain gain =
      GainOf(found, recordings, learning.IsToBeDecided() ? learning.Candidates() : causes);
  diagnosis::AddDoubtsOfHeldOut(gain, diagnosis);
  learned::Decide(gain, learning, diagnosis);
  if (!arguments.out.empty()) {
    simulation::ExtendedModel model = diagnosis::FoundModel(diagnosis, found, gain);
    for (const learned::Learned& term : learning.terms) {
      if (term.IsFound()) model.causes.push_back(simulation::ModelledTerm(term.term()));
    }
    WriteModel(std::move(model), arguments);
  }
  if (!arguments.json.empty())
    WriteResult(JsonOf(arguments, recordings, campaign, diagnosis, gain, learning), arguments.json);
  if (arguments.quiet) return kDone;
  fmt::print("{}{}", DiagnosisText(diagnosis, gain), LearnedText(learning));
  for (const std::string& note : campaign.notes()) fmt::print("\nNote: {}\n", note);
  for (const std::string& note : diagnosis.notes) fmt::print("\nNote: {}\n", note);
  return kDone;
}

}  // namespace

void AddDiagnose(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<DiagnoseArguments>();
  CLI::App* command = program.add_subcommand(
      "diagnose", "Finds the causes of what the simulation of the runs does not explain");
  command->add_option("recordings", arguments->recordings,
                      "Recordings of one machine: sweep, dwell, gap-steps, linkage, reference, "
                      "length, plate, shaft");
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
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer(
      "Example: abbe diagnose sweep_X.csv circle.csv cube.csv --machine mill.toml -o "
      "mill.causes.toml\n"
      "         abbe diagnose --plan --campaign standard --machine mill.toml");
  plan->excludes(out);
  command->callback([arguments, &exit_code] { exit_code = Diagnose(*arguments); });
}

}  // namespace abbe::apps
