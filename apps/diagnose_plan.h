// `abbe diagnose --plan`: the causes that planned runs would show.
// Units: SI. Failure: InputError for recordings whose kind cannot be planned with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diagnosis/plan.h"
#include "recording/recording.h"
#include "settings/document.h"
#include "simulation/instruments.h"

namespace abbe::apps {

struct PlanArguments {
  std::vector<std::filesystem::path> recordings;  // their paths are used, not their readings
  std::string campaign;                           // of the virtual rig; empty: none
  std::filesystem::path machine, json;
  bool quiet = false;
};

// The runs of a campaign of the virtual rig on the machine of a file. InputError for a campaign that
// there is not.
std::vector<recording::Recording> CampaignPaths(const settings::Document& machine,
                                                const std::string& campaign);
// What runs on these paths would show on a machine that is drawn, always the same one.
diagnosis::Plan PlanOfPaths(std::vector<recording::Recording> paths,
                            simulation::Instruments instruments);

// Returns the exit code. InputError without recordings and campaign.
int DiagnosePlan(const PlanArguments& arguments);

}  // namespace abbe::apps
