#include "rig/campaign_machine.h"

#include <algorithm>
#include <string>
#include <utility>

#include "rig/record_sweep.h"

namespace abbe::rig {

CampaignMachine ReadCampaignMachine(const settings::Table& root) {
  CampaignMachine machine{ReadRigSettings(root), {}, {}, {}};
  if (root.Has("linkage")) {
    machine.linkage = ReadLinkage(root);
    machine.sensors.links = machine.linkage->temperature;
  }
  machine.channels = ChannelsOf(hal::ReadDevices(root.Child("devices")));
  std::vector<std::string>& columns = machine.sensors.columns;
  for (const hal::Channel& channel : machine.channels) {
    if (channel.name.starts_with("temp_")) columns.push_back(channel.name);
  }
  const std::string& links = machine.sensors.links;
  if (!links.empty() && std::find(columns.begin(), columns.end(), links) == columns.end()) {
    columns.push_back(links);
  }
  return machine;
}

void ThinSweeps(CampaignMachine& machine, std::size_t stations) {
  for (auto& plan : machine.rig.sweeps) {
    if (!plan || plan->stations.size() <= stations) continue;
    const std::size_t intervals = plan->stations.size() - 1;
    const std::size_t every = (intervals + stations - 2) / (stations - 1);
    std::vector<double> kept;
    for (std::size_t i = 0; i < intervals; i += every) kept.push_back(plan->stations[i]);
    kept.push_back(plan->stations.back());
    plan->stations = std::move(kept);
  }
}

}  // namespace abbe::rig
