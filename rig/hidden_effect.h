// Hidden effects: those of rig/effects/registry.h with an object and sizes, from the text of
// `--hide` or from a seed.
//
//   HiddenEffects hidden = {ParseHidden("backlash:object=X:width_um=6", seed, sensors)};
//   SetInTime(hidden, {{.begin = 0.0, .duration = 700.0, .probes = true}});
//   const World world(settings, seed, hidden);
//
// Text: CAUSE:object=OBJECT[:key=value...], keys in the units of their names. A key that is not
// given is drawn by the seed from the range of the catalogue; keys of kind kInstant or kTurn stay
// open until the times of the recordings and the angles of the pivots are known (SetInTime).
// Failure: InputError in one line that names the nearest known cause, object or key.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "random/counter_random.h"
#include "rig/effects/effect.h"

namespace abbe::rig {

struct HiddenEffect {
  const Effect* entry;
  std::string object;
  std::vector<int> places;               // of the object: axes, probes, a pivot, a link, from 0
  std::map<std::string, double> values;  // in the units of the keys; NaN: open
  std::string sensor;                    // temperature column, where the cause has one
  std::vector<double> instants;          // of outliers, s since the machine was switched on
  random::CounterRandom random;          // its own stream

  int place() const { return places.front(); }
  // The value of a key, SI.
  double At(const std::string& key) const;
};

using HiddenEffects = std::vector<HiddenEffect>;

// The temperature columns that an effect can follow. Without a name it is the first, for a link
// that of the links.
struct Sensors {
  std::vector<std::string> columns;
  std::string links;  // empty: none
};

HiddenEffect ParseHidden(std::string_view text, std::uint64_t seed, const Sensors& sensors);

// A recording to be made: its time (s since the machine was switched on) and its instruments.
struct RecordedTime {
  double begin, duration;
  bool probes = false, linkage = false;
};

// Draws the open values: instants while their channel is recorded, angles near `turns` (rad) of the
// pivots. Without a recording or turns they stay open, and the effect does nothing.
void SetInTime(HiddenEffects& hidden, const std::vector<RecordedTime>& times,
               const std::vector<double>& turns = {});

// [{"cause", "object", "parameters": {key: value in its unit}}, ...]; an effect outside the
// catalogue of causes has "variable" too: the column, or the sum of columns, that it depends on.
nlohmann::ordered_json TruthOf(const HiddenEffects& hidden);

}  // namespace abbe::rig
