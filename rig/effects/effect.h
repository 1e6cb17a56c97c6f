// A kind of effect that the rig can hide: its name, the objects that it acts on, the keys of its
// sizes, and what it does.
//
// Ids, objects, keys and signs are those of `abbe diagnose`, with further effects that it does not
// know ("unknown-..."); docs/virtual-rig.md describes each. A key's unit is the end of its name
// (settings/unit.h). What an effect does is added where it belongs: constants of machine and head
// when the world is made, constants of the linkage when that is made, everything that depends on
// time, motion or temperature when a recording begins. Units: SI, but for the ranges of keys.
// Failure: none; names and values are checked by hidden_effect.h.
#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::rig {

struct HiddenEffect;  // hidden_effect.h
struct WorldParts;    // world_parts.h
struct LinkageParts;  // linkage_parts.h
struct RunParts;      // run_parts.h

// The kinds of object that an effect can act on; a bit each.
enum ObjectKind : std::uint16_t {
  kAxisObject = 1,       // X
  kPairObject = 2,       // XY XZ YZ
  kProbeObject = 4,      // probe_a
  kProbePairObject = 8,  // probe_a+probe_b
  kPivotObject = 16,     // pivot_1
  kLinkObject = 32,      // link_1
  kHeadObject = 64,      // head
  kFaceObject = 128,     // target_top target_side
  kCapObject = 256,      // cap
  kSourceObject = 512,   // linkage probes
};
inline constexpr unsigned kChannelObjects = kProbeObject | kPivotObject;

// The distribution, between its bounds, of a key without a given value.
enum class Draw : std::uint8_t {
  kUniform,
  kEven,        // uniform in its logarithm
  kEvenSigned,  // the same with a random sign
  kWhole,       // a whole number
  kEither,      // one of the two bounds
  kInstant,     // s since the machine was switched on: when a recording is made (hidden_effect.h)
  kTurn,        // rad, an angle that the pivot passes
};

struct KeyEntry {
  std::string_view name;
  Draw draw;
  double low = 0.0, high = 0.0;  // in the unit of the name
};

inline constexpr double kTurn = 2.0 * std::numbers::pi;
inline constexpr KeyEntry kPhase{"phase_rad", Draw::kUniform, 0.0, kTurn};
inline constexpr KeyEntry kFrom{"from_s", Draw::kInstant}, kTo{"to_s", Draw::kInstant};

// What it does not say, it does not do.
struct Effect {
  std::string_view name;
  unsigned objects;  // of ObjectKind
  std::vector<KeyEntry> keys = {};
  bool sensor = false;  // has a key `sensor`, the name of a temperature column
  void (*in_world)(const HiddenEffect&, WorldParts&) = nullptr;
  void (*in_linkage)(const HiddenEffect&, LinkageParts&) = nullptr;
  void (*in_run)(const HiddenEffect&, RunParts&) = nullptr;
  // For an effect that `abbe diagnose` does not know: the column, or the sum of columns, that it
  // depends on.
  std::string (*variable)(const HiddenEffect&) = nullptr;
  std::string_view instants = {};  // the key that counts the instants of HiddenEffect
};

}  // namespace abbe::rig
