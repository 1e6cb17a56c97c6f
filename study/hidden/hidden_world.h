// A world of the virtual rig that hides something, and what the diagnosis says of its recordings.
//
// The seed picks the machine, the cause, its object and its sizes; the diagnosis sees the machine
// file and the recordings only. Nothing here knows a model that is under test.
// Failure: InputError for a machine file without head, linkage or rig.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/campaign.h"
#include "machine/machine.h"
#include "probes/head_settings.h"
#include "random/counter_random.h"
#include "relm/linkage_settings.h"
#include "rig/campaign.h"
#include "settings/document.h"

namespace abbe::study {

// Lines of the machine file, and what is true of a machine that is rougher than it says.
using LinesAndTruth = std::vector<std::pair<std::string, std::string>>;
inline const LinesAndTruth kRougher{{"smoothness_mm = 15.0", "smoothness_mm = 8.0"},
                                    {"straightness_um = 1.0", "straightness_um = 2.0"},
                                    {"positioning_um = 2.0", "positioning_um = 4.0"}};

// A machine of the rig, reduced, its ball without drag in the cap: that drag is a cause.
class HiddenWorlds {
 public:
  enum class Noise { kAsStated, kWhite };

  HiddenWorlds(const std::filesystem::path& machine_file, rig::CampaignKind kind,
               Noise noise = Noise::kAsStated);

  // A machine of other errors and noise than the file says: lines of the file and what is true.
  HiddenWorlds Unlike(const LinesAndTruth& lines) const;

  const rig::CampaignMachine& machine() const { return machine_; }
  const simulation::Instruments& setup() const { return setup_; }

  // The same, with encoders that do not count in steps.
  HiddenWorlds WithoutCounts() const {
    HiddenWorlds worlds = *this;
    worlds.machine_.rig.encoder_counts = 1e14;
    return worlds;
  }

  // The same, with a ball that is seated anew for each run, m; `stated` in the machine file.
  HiddenWorlds WithSeats(double drawn, double stated) const {
    HiddenWorlds worlds = *this;
    worlds.machine_.linkage->seat = drawn;
    worlds.setup_.linkage->tolerance.seat = stated;
    return worlds;
  }

  // The same, with a ball that trails in its cap by up to so much, m.
  HiddenWorlds WithTrailing(double most) const {
    HiddenWorlds worlds = *this;
    worlds.machine_.rig.cap = most;
    return worlds;
  }

  // The same, without white noise of probes and encoders, for a test that adds its own.
  HiddenWorlds Quiet() const {
    HiddenWorlds worlds = WithoutCounts();
    worlds.machine_.rig.white = 0.0;
    worlds.machine_.linkage->encoder_noise = 0.0;
    return worlds;
  }

  rig::Campaign Record(std::uint64_t seed, const std::vector<std::string>& hidden) const;

  rig::Campaign RecordEffects(std::uint64_t seed, rig::HiddenEffects effects) const;

  diagnosis::Campaign Recordings(const rig::Campaign& world) const;

 private:
  std::filesystem::path path_;
  settings::Document document_;
  rig::CampaignMachine machine_;
  simulation::Instruments setup_;
  rig::CampaignKind kind_;
};

// Text for Record(): a cause that is known (or not), with an object it can act on; sizes are left
// to the rig.
std::string DrawHidden(const random::CounterRandom& random, std::uint64_t first, bool known);

}  // namespace abbe::study
