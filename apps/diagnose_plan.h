// `abbe diagnose --plan`: which causes runs would show before they are made.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace abbe::apps {

struct PlanArguments {
  std::vector<std::filesystem::path> recordings;  // their paths count, not their readings
  std::string campaign;                           // of the rig; empty: none
  std::filesystem::path machine, json;
  bool quiet = false;
};

// The exit code. InputError when there is nothing to plan with.
int DiagnosePlan(const PlanArguments& arguments);

}  // namespace abbe::apps
