// A world of the virtual rig that hides something, and what the diagnosis says of its recordings.
//
// The seed picks the machine, the cause, its object and its sizes; the diagnosis sees the machine
// file and the recordings only. Nothing here knows a model that is under test.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/measured_noise.h"
#include "machine/machine.h"
#include "probes/head_settings.h"
#include "random/counter_random.h"
#include "relm/linkage_settings.h"
#include "rig/campaign.h"
#include "rig/effects/registry.h"
#include "settings/document.h"

namespace abbe {

// Lines of the machine file, and what is true of a machine that is rougher than it says.
inline const std::vector<std::pair<std::string, std::string>> kRougher{
    {"smoothness_mm = 15.0", "smoothness_mm = 8.0"},
    {"straightness_um = 1.0", "straightness_um = 2.0"},
    {"positioning_um = 2.0", "positioning_um = 4.0"}};

// The demonstration machine, reduced, its ball without drag in the cap: that drag is a cause.
class HiddenWorlds {
 public:
  enum class Noise { kAsStated, kWhite };

  explicit HiddenWorlds(rig::CampaignKind kind, Noise noise = Noise::kAsStated)
      : document_(settings::Document::Read(std::filesystem::path(ABBE_SOURCE_DIR) /
                                           "machines/demo_mill.toml")),
        machine_(rig::ReadCampaignMachine(document_.Root())),
        setup_{machine::ReadMachine(document_.Root()), probes::ReadHeadSettings(document_.Root()),
               probes::ReadTargetSettings(document_.Root()),
               probes::ReadProbeNoise(document_.Root()),
               relm::ReadLinkageSettings(document_.Root())},
        kind_(kind) {
    machine_.rig.cap = 0.0;
    if (noise == Noise::kWhite) machine_.rig.drift = 0.0;
  }

  // A machine of other errors and noise than the file says: lines of the file and what is true.
  HiddenWorlds Unlike(const std::vector<std::pair<std::string, std::string>>& lines) const {
    const auto path = std::filesystem::path(ABBE_SOURCE_DIR) / "machines/demo_mill.toml";
    std::ostringstream read;
    read << std::ifstream(path).rdbuf();
    std::string text = read.str();
    for (const auto& [stated, real] : lines) text.replace(text.find(stated), stated.size(), real);
    HiddenWorlds worlds = *this;
    const double drift = worlds.machine_.rig.drift;
    worlds.machine_ =
        rig::ReadCampaignMachine(settings::Document::Parse(text, "world.toml").Root());
    worlds.machine_.rig.cap = 0.0;
    worlds.machine_.rig.drift = drift;
    return worlds;
  }

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

  // The same, without white noise of probes and encoders, for a test that adds its own.
  HiddenWorlds Quiet() const {
    HiddenWorlds worlds = WithoutCounts();
    worlds.machine_.rig.white = 0.0;
    worlds.machine_.linkage->encoder_noise = 0.0;
    return worlds;
  }

  rig::Campaign Record(std::uint64_t seed, const std::vector<std::string>& hidden) const {
    rig::HiddenEffects effects;
    for (const std::string& text : hidden) {
      effects.push_back(rig::ParseHidden(text, seed, machine_.sensors));
    }
    return RecordEffects(seed, std::move(effects));
  }

  rig::Campaign RecordEffects(std::uint64_t seed, rig::HiddenEffects effects) const {
    return rig::RecordCampaign(machine_, seed, std::move(effects),
                               {.kind = kind_, .reduced = true});
  }

  diagnosis::Campaign Recordings(const rig::Campaign& world) const {
    simulation::Instruments setup = setup_;
    diagnosis::UseMeasuredNoise(world.recordings, setup);
    diagnosis::Campaign campaign(std::move(setup));
    for (const auto& recording : world.recordings) campaign.Add(recording);
    return campaign;
  }

 private:
  settings::Document document_;
  rig::CampaignMachine machine_;
  simulation::Instruments setup_;
  rig::CampaignKind kind_;
};

// Text for Record(): a cause that is known (or not), with an object it can act on; sizes are left
// to the rig.
inline std::string DrawHidden(const random::CounterRandom& random, std::uint64_t first,
                              bool known) {
  static const std::vector<std::pair<unsigned, std::vector<std::string>>> kObjects = {
      {rig::kAxisObject, {"X", "Y", "Z"}},
      {rig::kPairObject, {"XY", "XZ", "YZ"}},
      {rig::kProbeObject, {"probe_a", "probe_b", "probe_c", "probe_d", "probe_e"}},
      {rig::kProbePairObject, {"probe_a+probe_b", "probe_d+probe_e", "probe_b+probe_d"}},
      {rig::kPivotObject, {"pivot_1", "pivot_2", "pivot_3"}},
      {rig::kLinkObject, {"link_1", "link_2"}},
      {rig::kHeadObject, {"head"}},
      {rig::kFaceObject, {"target_top", "target_side"}},
      {rig::kCapObject, {"cap"}},
      {rig::kSourceObject, {"linkage", "probes"}}};
  std::vector<std::pair<std::string_view, std::string>> choices;
  std::vector<std::string_view> names;
  for (const rig::Effect& entry : rig::EffectCatalogue()) {
    if ((entry.variable == nullptr) != known) continue;
    names.push_back(entry.name);
    for (const auto& [kind, objects] : kObjects) {
      if ((entry.objects & kind) == 0) continue;
      for (const std::string& object : objects) choices.emplace_back(entry.name, object);
    }
  }
  // Each cause alike, then its objects.
  const auto pick = [&](std::uint64_t index, std::size_t count) {
    return static_cast<std::size_t>(random.Uniform(first + index, 0.0, 1.0) *
                                    static_cast<double>(count));
  };
  const std::string_view name = names[pick(0, names.size())];
  std::erase_if(choices, [&](const auto& choice) { return choice.first != name; });
  const auto& [cause, object] = choices[pick(1, choices.size())];
  return std::string(cause) + ":object=" + object;
}

}  // namespace abbe
