// The worlds of study/hidden on the demonstration machine.
#pragma once

#include "study/hidden/hidden_world.h"

namespace abbe {

using study::DrawHidden;
using study::kRougher;

class HiddenWorlds : public study::HiddenWorlds {
 public:
  explicit HiddenWorlds(rig::CampaignKind kind, Noise noise = Noise::kAsStated)
      : study::HiddenWorlds(std::filesystem::path(ABBE_SOURCE_DIR) / "machines/demo_mill.toml",
                            kind, noise) {}
  HiddenWorlds(const study::HiddenWorlds& other) : study::HiddenWorlds(other) {}
};

}  // namespace abbe
