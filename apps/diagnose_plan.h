// `abbe diagnose --plan`: the causes that planned runs would show.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace abbe::apps {

struct PlanArguments {
  std::vector<std::filesystem::path> recordings;  // their paths are used, not their readings
  std::string campaign;                           // of the virtual rig; empty: none
  std::filesystem::path machine, json;
  bool quiet = false;
};

// Returns the exit code. InputError without recordings and campaign.
int DiagnosePlan(const PlanArguments& arguments);

}  // namespace abbe::apps
