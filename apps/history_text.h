// The tables and sentences of `abbe history`.
//
// Numbers are rounded by their U95 (apps/rounded.h). Texts of people appear as they are, without
// control characters.
#pragma once

#include <string>
#include <vector>

#include "history/comparison.h"
#include "history/conformity.h"
#include "history/store.h"
#include "history/trend.h"

namespace abbe::apps {

std::string CampaignTable(const std::vector<history::CampaignHead>& campaigns);
std::string CampaignText(const history::StoredCampaign& campaign);

std::string ComparisonText(const history::Comparison& comparison);
// One sentence for a change, "EYX straightness grew by 1.20 +- 0.30 um, from 2.10 to 3.30 um".
std::string ChangeText(const history::Difference& difference);

std::string TrendText(const history::Trend& trend);
// What the figure does, and when it meets its limit.
std::string DriftText(const history::Trend& trend);

std::string CheckText(const std::vector<history::Judged>& judged);

// "EYX.straightness_um" -> "EYX straightness", and its unit "um".
std::string QuantityName(const std::string& name);
std::string QuantityUnit(const std::string& quantity);

// Without control characters, which could move the cursor of a terminal.
std::string Printable(const std::string& text);

}  // namespace abbe::apps
