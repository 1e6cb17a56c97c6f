// The campaigns of the virtual rig by their names on the command line.
#pragma once

#include <map>
#include <string>

#include "rig/campaign.h"

namespace abbe::apps {

inline const std::map<std::string, rig::CampaignKind>& CampaignKinds() {
  static const std::map<std::string, rig::CampaignKind> kinds{
      {"minimal", rig::CampaignKind::kMinimal},
      {"standard", rig::CampaignKind::kStandard},
      {"full", rig::CampaignKind::kFull}};
  return kinds;
}

}  // namespace abbe::apps
