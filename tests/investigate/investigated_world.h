// A world of the virtual rig that is investigated from nothing. The recorder knows the world; the
// investigation sees the machine file and the recordings only.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../folders.h"
#include "investigate/investigation.h"
#include "machine/machine.h"
#include "probes/head_settings.h"
#include "recording/recording_file.h"
#include "relm/linkage_settings.h"
#include "rig/planned_recorder.h"
#include "settings/document.h"

namespace abbe {

// A folder of the test, empty at first.
inline std::filesystem::path EmptyFolder(const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() / ("abbe_investigate_" + name);
  std::filesystem::remove_all(folder);
  return folder;
}

// The demonstration machine, its ball without drag in the cap: that drag is a cause. The world is
// as the machine file says, or as `world` does.
class InvestigatedMachine {
 public:
  InvestigatedMachine() : InvestigatedMachine(settings::Document::Read(DemoMillFile())) {}
  explicit InvestigatedMachine(const settings::Document& world)
      : document_(settings::Document::Read(DemoMillFile())),
        rig_(rig::ReadCampaignMachine(world.Root())) {
    rig_.rig.cap = 0.0;
    subject_.instruments = {
        machine::ReadMachine(document_.Root()), probes::ReadHeadSettings(document_.Root()),
        probes::ReadTargetSettings(document_.Root()), probes::ReadProbeNoise(document_.Root()),
        relm::ReadLinkageSettings(document_.Root())};
    subject_.costs = investigate::ReadCosts(document_.Root(), subject_.instruments);
    subject_.sensors = rig_.sensors.columns;
  }

  const rig::CampaignMachine& rig() const { return rig_; }
  investigate::Subject& subject() { return subject_; }

  // The effects of a world.
  rig::HiddenEffects Hidden(std::uint64_t seed, const std::vector<std::string>& texts) const {
    rig::HiddenEffects hidden;
    for (const std::string& text : texts) {
      hidden.push_back(rig::ParseHidden(text, seed, rig_.sensors));
    }
    return hidden;
  }

 private:
  settings::Document document_;
  rig::CampaignMachine rig_;
  investigate::Subject subject_;
};

inline constexpr double kStarted = 1'795'248'000;  // 2026-11-21, 08:00

class WorldRecorder : public investigate::Recorder {
 public:
  WorldRecorder(const rig::CampaignMachine& machine, std::uint64_t seed, rig::HiddenEffects hidden)
      : rig_(machine, seed, std::move(hidden), kStarted) {}

  bool Records(const recording::Recording& path) const override { return rig_.Records(path); }
  std::optional<std::string> Record(const recording::Recording& path,
                                    const investigate::Journal& journal) override {
    const std::string name = std::to_string(journal.number()) + "_" + path.Kind() + ".h5";
    std::filesystem::remove(journal.folder() / name);
    recording::Write(rig_.Record(path, journal.number()), journal.folder() / name);
    ++recorded;
    return name;
  }

  const rig::HiddenEffects& hidden() const { return rig_.hidden(); }

  int recorded = 0;

 private:
  rig::PlannedRecorder rig_;
};

inline investigate::About AboutDemo() { return {"demo-mill", "test", kStarted}; }

}  // namespace abbe
