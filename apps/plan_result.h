// The result of `abbe diagnose --plan` as data (docs/diagnose.md) and as text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diagnosis/plan.h"

namespace abbe::apps {

nlohmann::ordered_json PlanJson(const diagnosis::Plan& plan);
std::string PlanText(const diagnosis::Plan& plan);

}  // namespace abbe::apps
