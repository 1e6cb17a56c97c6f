// A whole campaign of measurements on the rig, made in memory: sweeps, courses of the linkage,
// lengths and standstills, one after the other, on one machine that hides what it was told to.
//
//   const CampaignMachine machine = ReadCampaignMachine(document.Root());
//   HiddenEffects hidden = {ParseHidden("backlash:object=X", 7, machine.sensors)};
//   const Campaign campaign =
//       RecordCampaign(machine, 7, hidden, {.kind = CampaignKind::kStandard});
//   // campaign.recordings: "01_sweep_X", "02_sweep_Y", ...; campaign.hidden: with all its numbers
//
// docs/virtual-rig.md lists the recordings of each kind and what their headers say. The machine is
// switched on when the first recording begins: warm-up and instants count from there through all of
// them, and the temperatures go on from one to the next. Runs that the machine file has no table
// for (a sweep, the linkage) are left out. `reduced`: the same structure of fewer stations, places
// and rows, for statistics. The same (machine file, seed, hidden effects, plan) gives the same
// campaign, and without effects the same machine as abbe rig serves.
// Failure: InputError when nothing can be recorded, or a place is out of the linkage's reach.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "recording/recording.h"
#include "rig/campaign_machine.h"
#include "rig/hidden_effect.h"

namespace abbe::rig {

enum class CampaignKind : std::uint8_t { kMinimal, kStandard, kFull };

struct CampaignPlan {
  CampaignKind kind = CampaignKind::kStandard;
  bool reduced = false;
  // When the machine was switched on: 2026-11-21, 08:00.
  std::chrono::sys_seconds started{std::chrono::seconds(1'795'248'000)};
};

struct Campaign {
  std::vector<recording::Recording> recordings;  // named by number and what they are
  HiddenEffects hidden;                          // nothing left open
};

Campaign RecordCampaign(const CampaignMachine& machine, std::uint64_t seed, HiddenEffects hidden,
                        const CampaignPlan& plan);

}  // namespace abbe::rig
