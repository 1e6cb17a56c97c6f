// The result of `abbe align` as data and in words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "probes/channel_noise.h"
#include "probes/head_alignment.h"
#include "probes/head_wiring.h"

namespace abbe::apps {

// How an alignment ended, or stands.
enum class AlignEnd { kReady, kGoesOn, kWrongWiring, kOutOfReach, kStopped };

struct AlignStatus {
  char axis = 'X';
  std::string machine, started, mounting;
  bool simulated = false;
  AlignEnd end = AlignEnd::kGoesOn;
  double first = 0.0, last = 0.0;  // m, of the travel
  std::vector<probes::GapsAt> readings;
  std::vector<std::vector<probes::ScrewTurn>> turned;
  std::optional<probes::HeadAlignment> alignment;     // of the last setting
  std::vector<std::string> wiring;                    // what is wrong; several: one of them
  std::vector<std::string> open;                      // of the wiring: not excluded
  probes::PerProbe<probes::ChannelNoise> noise = {};  // m, of the last readings
  std::vector<std::string> notes;
};

// docs/align.md lists the keys. SI units.
nlohmann::ordered_json AlignJson(const AlignStatus& status, const probes::AlignSettings& settings);

// The table of the gaps over the travel and the tilts; ends in a newline.
std::string AlignTable(const AlignStatus& status, const probes::AlignSettings& settings);

// "base_left 0.35 turns clockwise"; without screws what the hands do, in words.
std::vector<std::string> TurnLines(std::span<const probes::ScrewTurn> turns,
                                   const probes::HeadAlignment& alignment,
                                   const probes::AlignSettings& settings);

// Noise and mains of the channels that stand out of [noise].
std::vector<std::string> NoiseNotes(const probes::PerProbe<probes::ChannelNoise>& noise,
                                    double stated);

}  // namespace abbe::apps
