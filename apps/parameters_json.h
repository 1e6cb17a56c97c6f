// The parameters of a fit as data: a list of name, unit, value, uncertainty, nominal, prior,
// seen_by.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/result.h"

namespace abbe::apps {

nlohmann::ordered_json ParametersJson(const estimation::Result& fit);

}  // namespace abbe::apps
