#include "apps/diagnose_plan.h"

#include <fmt/format.h>

#include <utility>

#include "apps/campaign_kinds.h"
#include "apps/command.h"
#include "apps/instruments.h"
#include "apps/plan_result.h"
#include "apps/result_file.h"
#include "apps/working_line.h"
#include "failure/failure.h"
#include "random/counter_random.h"
#include "recording/recording_file.h"
#include "simulation/kinds.h"

namespace abbe::apps {
namespace {

constexpr std::uint64_t kSeed = 1, kStream = 0x91A7;  // of the drawn machine

std::vector<recording::Recording> PathsOf(const PlanArguments& arguments, const MachineFile& file) {
  std::vector<recording::Recording> paths;
  for (const auto& path : arguments.recordings) paths.push_back(recording::Read(path));
  if (!arguments.campaign.empty()) {
    for (auto& path : CampaignPaths(file.document, arguments.campaign)) {
      paths.push_back(std::move(path));
    }
  }
  if (paths.empty()) {
    throw InputError(
        "--plan: no run to plan with; name recordings with the paths of the runs, or a campaign: "
        "--campaign standard");
  }
  return paths;
}

}  // namespace

std::vector<recording::Recording> CampaignPaths(const settings::Document& machine,
                                                const std::string& campaign) {
  const auto& kinds = CampaignKinds();
  const auto kind = kinds.find(campaign);
  if (kind == kinds.end()) {
    throw InputError(
        fmt::format("campaign: \"{}\"; give \"minimal\", \"standard\" or \"full\"", campaign));
  }
  const rig::CampaignPlan plan{.kind = kind->second};
  return rig::RecordCampaign(rig::ReadCampaignMachine(machine.Root()), kSeed, {}, plan).recordings;
}

diagnosis::Plan PlanOfPaths(std::vector<recording::Recording> paths,
                            simulation::Instruments instruments) {
  diagnosis::Campaign campaign(std::move(instruments));
  for (auto& path : paths) path = simulation::Planned(std::move(path), campaign.instruments());
  campaign.Add(std::move(paths));
  const random::CounterRandom random(kSeed, kStream);
  std::uint64_t index = 0;
  return diagnosis::PlanOf(campaign, [&] { return random.Normal(index++); });
}

int DiagnosePlan(const PlanArguments& arguments) {
  const MachineFile file = ReadMachineFile(arguments.machine);
  auto paths = PathsOf(arguments, file);
  std::vector<std::string> runs;
  runs.reserve(paths.size());
  for (const auto& path : paths) {
    runs.push_back(std::filesystem::path(path.name).filename().string());
  }
  const diagnosis::Plan plan = [&] {
    const WorkingLine line("diagnose --plan", arguments.quiet);
    return PlanOfPaths(std::move(paths), InstrumentsOf(file));
  }();
  if (!arguments.json.empty()) {
    auto json = PlanJson(plan);
    json["abbe"] = ABBE_VERSION;
    json["machine"] = file.sweep_setup.machine.name;
    json["runs"] = runs;
    WriteResult(json, arguments.json);
  }
  if (!arguments.quiet) fmt::print("{}", PlanText(plan));
  return kDone;
}

}  // namespace abbe::apps
