// The results of `abbe history` as data (docs/history.md): "command": "history" and a "kind".
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "history/comparison.h"
#include "history/conformity.h"
#include "history/store.h"
#include "history/trend.h"

namespace abbe::apps {

nlohmann::ordered_json CampaignsJson(const std::vector<history::CampaignHead>& campaigns);
nlohmann::ordered_json CampaignJson(const history::StoredCampaign& campaign);
nlohmann::ordered_json ComparisonJson(const history::Comparison& comparison);
nlohmann::ordered_json TrendsJson(const std::string& machine,
                                  const std::vector<history::Trend>& trends,
                                  const std::vector<std::string>& notes);
nlohmann::ordered_json CheckJson(const std::string& machine, const std::string& of,
                                 const std::vector<history::Judged>& judged);

}  // namespace abbe::apps
