#include "apps/diagnose_plan.h"

#include <fmt/format.h>

#include <utility>

#include "apps/campaign_kinds.h"
#include "apps/command.h"
#include "apps/instruments.h"
#include "apps/plan_result.h"
#include "apps/result_file.h"
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
    const auto machine = rig::ReadCampaignMachine(file.document.Root());
    const rig::CampaignPlan plan{.kind = CampaignKinds().at(arguments.campaign)};
    for (auto& recorded : rig::RecordCampaign(machine, kSeed, {}, plan).recordings) {
      paths.push_back(std::move(recorded));
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

int DiagnosePlan(const PlanArguments& arguments) {
  const MachineFile file = ReadMachineFile(arguments.machine);
  diagnosis::Campaign campaign(InstrumentsOf(file));
  std::vector<std::string> runs;
  std::vector<recording::Recording> planned;
  for (auto& path : PathsOf(arguments, file)) {
    runs.push_back(std::filesystem::path(path.name).filename().string());
    planned.push_back(simulation::Planned(std::move(path), campaign.instruments()));
  }
  campaign.Add(std::move(planned));
  const random::CounterRandom random(kSeed, kStream);
  std::uint64_t index = 0;
  const diagnosis::Plan plan = diagnosis::PlanOf(campaign, [&] { return random.Normal(index++); });
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
