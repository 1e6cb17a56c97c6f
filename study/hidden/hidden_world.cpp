#include "study/hidden/hidden_world.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <string_view>

#include "diagnosis/measured_noise.h"
#include "failure/failure.h"
#include "rig/effects/registry.h"

namespace abbe::study {

HiddenWorlds::HiddenWorlds(const std::filesystem::path& machine_file, rig::CampaignKind kind,
                           Noise noise)
    : path_(machine_file),
      document_(settings::Document::Read(machine_file)),
      machine_(rig::ReadCampaignMachine(document_.Root())),
      setup_{machine::ReadMachine(document_.Root()), probes::ReadHeadSettings(document_.Root()),
             probes::ReadTargetSettings(document_.Root()), probes::ReadProbeNoise(document_.Root()),
             relm::ReadLinkageSettings(document_.Root())},
      kind_(kind) {
  machine_.rig.cap = 0.0;
  if (noise == Noise::kWhite) machine_.rig.drift = 0.0;
}

HiddenWorlds HiddenWorlds::Unlike(const LinesAndTruth& lines) const {
  std::ostringstream read;
  read << std::ifstream(path_).rdbuf();
  std::string text = read.str();
  for (const auto& [stated, real] : lines) {
    const std::size_t at = text.find(stated);
    if (at == std::string::npos) {
      throw InputError(
          fmt::format("{}: has no line \"{}\", which these worlds change; give the "
                      "demonstration machine",
                      path_.string(), stated));
    }
    text.replace(at, stated.size(), real);
  }
  HiddenWorlds worlds = *this;
  const double drift = worlds.machine_.rig.drift;
  worlds.machine_ = rig::ReadCampaignMachine(settings::Document::Parse(text, "world.toml").Root());
  worlds.machine_.rig.cap = 0.0;
  worlds.machine_.rig.drift = drift;
  return worlds;
}

rig::Campaign HiddenWorlds::Record(std::uint64_t seed,
                                   const std::vector<std::string>& hidden) const {
  rig::HiddenEffects effects;
  for (const std::string& text : hidden) {
    effects.push_back(rig::ParseHidden(text, seed, machine_.sensors));
  }
  return RecordEffects(seed, std::move(effects));
}

rig::Campaign HiddenWorlds::RecordEffects(std::uint64_t seed, rig::HiddenEffects effects) const {
  return rig::RecordCampaign(machine_, seed, std::move(effects), {.kind = kind_, .reduced = true});
}

diagnosis::Campaign HiddenWorlds::Recordings(const rig::Campaign& world) const {
  simulation::Instruments setup = setup_;
  diagnosis::UseMeasuredNoise(world.recordings, setup);
  diagnosis::Campaign campaign(std::move(setup));
  campaign.Add(world.recordings);
  return campaign;
}

std::string DrawHidden(const random::CounterRandom& random, std::uint64_t first, bool known) {
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
    return static_cast<std::size_t>(random.Uniform(first + index) * static_cast<double>(count));
  };
  const std::string_view name = names[pick(0, names.size())];
  std::erase_if(choices, [&](const auto& choice) { return choice.first != name; });
  const auto& [cause, object] = choices[pick(1, choices.size())];
  return std::string(cause) + ":object=" + object;
}

}  // namespace abbe::study
