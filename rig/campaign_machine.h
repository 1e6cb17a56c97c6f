// The parts of the machine file that a campaign needs.
//
// Units: SI. Failure: InputError with file, line and key.
#pragma once

#include <optional>
#include <vector>

#include "hal/sample_source.h"
#include "rig/hidden_effect.h"
#include "rig/linkage_settings.h"
#include "rig/rig_settings.h"

namespace abbe::rig {

struct CampaignMachine {
  RigSettings rig;
  std::optional<LinkageSettings> linkage;
  std::vector<hal::Channel> channels;  // of the sweeps
  Sensors sensors;                     // that its devices and its linkage have
};
CampaignMachine ReadCampaignMachine(const settings::Table& root);

// Keeps about `stations` of the stations of each sweep, with the first and the last.
void ThinSweeps(CampaignMachine& machine, std::size_t stations);

}  // namespace abbe::rig
