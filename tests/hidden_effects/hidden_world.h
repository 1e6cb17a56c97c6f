// The worlds of study/hidden on the demonstration machine.
#pragma once

#include "../folders.h"
#include "study/hidden/hidden_world.h"

namespace abbe {

using study::DrawHidden;
using study::kRougher;

class HiddenWorlds : public study::HiddenWorlds {
 public:
  explicit HiddenWorlds(rig::CampaignKind kind, Noise noise = Noise::kAsStated)
      : study::HiddenWorlds(DemoMillFile(), kind, noise) {}
  HiddenWorlds(const study::HiddenWorlds& other) : study::HiddenWorlds(other) {}
};

}  // namespace abbe
