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
#include "apps/file_hash.h"
#include "apps/machine_file.h"
#include "apps/machine_recording.h"
#include "apps/result_file.h"
#include "diagnosis/found_model.h"
#include "diagnosis/measured_noise.h"
#include "diagnosis/next_run.h"
#include "failure/failure.h"
#include "settings/toml_text.h"
#include "simulation/linkage/one_ball.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

struct DiagnoseArguments {
  std::vector<fs::path> recordings;
  fs::path machine, out, json;
  std::string campaign;  // of the plan
  bool plan = false, quiet = false;
};

// A file without [devices] is sufficient for runs with a reference, for an arm, and for a shaft.
diagnosis::Setup SetupOf(const fs::path& machine) {
  const auto document = settings::Document::Read(machine);
  if (!document.Root().Has("devices")) {
    MachineAlone alone = ReadMachineAlone(document);
    return {std::move(alone.machine), std::nullopt, {}, {}, std::move(alone.linkage)};
  }
  const MachineFile file = ReadMachineFile(machine);
  const auto& setup = file.sweep_setup;
  return {setup.machine, setup.head, setup.target, setup.noise, file.linkage};
}

void WriteModel(simulation::ExtendedModel model, const DiagnoseArguments& arguments) {
  for (const fs::path& path : arguments.recordings) {
    model.sources.push_back({path.filename().string(), Sha256Of(path)});
  }
  WriteText(simulation::ExtendedModelText(model), arguments.out);
}

nlohmann::ordered_json JsonOf(const DiagnoseArguments& arguments,
                              const diagnosis::Campaign& campaign,
                              const diagnosis::Diagnosis& diagnosis,
                              const diagnosis::HeldOutGain& gain) {
  auto json = DiagnosisJson(diagnosis, gain);
  json["abbe"] = ABBE_VERSION;
  json["machine"] = campaign.setup().machine.name;
  for (const fs::path& path : arguments.recordings) {
    json["recordings"].push_back(path.filename().string());
  }
  json["notes"] = campaign.notes();
  if (!arguments.out.empty()) json["model"] = arguments.out.filename().string();
  return json;
}

diagnosis::HeldOutGain GainOf(const diagnosis::Campaign& campaign,
                              const std::vector<recording::Recording>& recordings,
                              const std::vector<diagnosis::Candidate>& causes) {
  // The error of an arm in held-out poses is reported also without a cause.
  if (causes.empty() && !campaign.HasArms()) return {};
  try {
    return diagnosis::HoldOut(campaign, recordings, causes);
  } catch (const NumericalError& error) {
    fmt::print(stderr,
               "abbe: the gain on held-out data is unknown, because half of the runs do not "
               "suffice for a fit: {}\n",
               error.what());
    return {};
  }
}

void RefuseOtherBall(const std::vector<recording::Recording>& recordings,
                     const diagnosis::Setup& setup) {
  simulation::OneBall ball;
  for (const recording::Recording& recording : recordings) {
    if (!setup.linkage || recording.HeaderText("kind") != "linkage") continue;
    ball.Add(recording,
             simulation::MeansOfStays(simulation::ReadLinkageRun(recording, *setup.linkage)));
  }
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
  diagnosis::Setup setup = SetupOf(arguments.machine);
  RefuseOtherBall(recordings, setup);
  diagnosis::UseMeasuredNoise(recordings, setup);
  diagnosis::Campaign campaign(std::move(setup));
  for (const recording::Recording& recording : recordings) campaign.Add(recording);
  diagnosis::Diagnosis diagnosis = diagnosis::Diagnose(campaign);
  diagnosis::AddNextRuns(campaign, recordings, diagnosis);
  std::vector<diagnosis::Candidate> causes;
  for (const auto& finding : diagnosis.findings) {
    if (diagnosis::IsModelled(finding)) causes.push_back(finding.score.candidate);
  }
  const diagnosis::HeldOutGain gain = GainOf(campaign, recordings, causes);
  if (!arguments.out.empty()) {
    WriteModel(diagnosis::FoundModel(diagnosis, campaign, gain), arguments);
  }
  if (!arguments.json.empty())
    WriteResult(JsonOf(arguments, campaign, diagnosis, gain), arguments.json);
  if (arguments.quiet) return kDone;
  fmt::print("{}", DiagnosisText(diagnosis, gain));
  for (const std::string& note : campaign.notes()) fmt::print("\nNote: {}\n", note);
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
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer(
      "Example: abbe diagnose sweep_X.csv circle.csv cube.csv --machine mill.toml -o "
      "mill.causes.toml\n"
      "         abbe diagnose --plan --campaign standard --machine mill.toml");
  plan->excludes(out);
  command->callback([arguments, &exit_code] { exit_code = Diagnose(*arguments); });
}

}  // namespace abbe::apps
