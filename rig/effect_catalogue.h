// The effects that the rig can hide: their names, the objects that they act on, and the keys of
// their sizes.
//
// Ids, objects, keys and signs are those of `abbe diagnose`, with further effects that it does not
// know ("unknown-..."); docs/virtual-rig.md describes each. A key's unit is the end of its name
// (settings/unit.h). A cause with different keys for different kinds of object has an entry for
// each.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace abbe::rig {

enum class Cause : std::uint8_t {
  kBacklash,
  kLeadscrewCyclic,
  kScaleError,
  kSquareness,
  kThermalGrowth,
  kWarmUpDrift,
  kServoLagMismatch,
  kServoLag,
  kReversalSpike,
  kLoadCoupling,
  kProbeGain,
  kProbeNonlinearity,
  kProbePosition,
  kFixtureMisalignment,
  kProbeTiltResponse,
  kProbeCrosstalk,
  kTargetForm,
  kChannelSwap,
  kChannelSign,
  kMainsPickup,
  kVibration,
  kEncoderEccentricity,
  kEncoderSubdivision,
  kEncoderCountSlip,
  kBearingRoundness,
  kLinkThermalGrowth,
  kLinkGravityBend,
  kJointHysteresis,
  kCapFriction,
  kClockSkew,
  kStuckChannel,
  kOutliers,
  kUnknownHum,
  kUnknownStepAndBack,
  kUnknownWarmthSquare,
  kUnknownIdleAxis,
  kUnknownFeedSquare,
  kUnknownDiagonalRipple,
  kUnknownAngleBump,
  kUnknownWander,
};

// The kinds of object that a cause can act on; a bit each.
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

struct CauseEntry {
  Cause cause;
  std::string_view name;
  unsigned objects;  // of ObjectKind
  std::vector<KeyEntry> keys;
  bool sensor = false;             // has a key `sensor`, the name of a temperature column
  std::string_view variable = {};  // of an effect unknown to `abbe diagnose`: what it depends on
};

const std::vector<CauseEntry>& EffectCatalogue();

}  // namespace abbe::rig
