#include "rig/effect_catalogue.h"

#include <numbers>

namespace abbe::rig {
namespace {

constexpr double kTurnOn = 2.0 * std::numbers::pi;

const KeyEntry kPhase{"phase_rad", Draw::kUniform, 0.0, kTurnOn};
const KeyEntry kFrom{"from_s", Draw::kInstant}, kTo{"to_s", Draw::kInstant};

}  // namespace

const std::vector<CauseEntry>& EffectCatalogue() {
  using enum Draw;
  constexpr unsigned kChannel = kProbeObject | kPivotObject;
  static const std::vector<CauseEntry> entries = {
      // Machine motion.
      {Cause::kBacklash, "backlash", kAxisObject, {{"width_um", kEven, 1.0, 15.0}}},
      {Cause::kLeadscrewCyclic, "leadscrew-cyclic", kAxisObject,
       {{"pitch_mm", kUniform, 4.0, 10.0}, {"amplitude_um", kEven, 0.3, 4.0}, kPhase}},
      {Cause::kScaleError, "scale-error", kAxisObject, {{"gain_ppm", kEvenSigned, 20.0, 300.0}}},
      {Cause::kSquareness, "squareness", kPairObject, {{"angle_urad", kEvenSigned, 20.0, 300.0}}},
      {Cause::kThermalGrowth, "thermal-growth", kAxisObject,
       {{"coefficient_ppm_per_c", kEven, 3.0, 20.0}}, true},
      {Cause::kWarmUpDrift, "warm-up-drift", kAxisObject,
       {{"amplitude_um", kEvenSigned, 1.0, 10.0}, {"time_constant_s", kEven, 300.0, 1800.0}}},
      {Cause::kWarmUpDrift, "warm-up-drift", kProbeObject,
       {{"amplitude_um", kEvenSigned, 0.1, 2.0}, {"time_constant_s", kEven, 300.0, 1800.0}}},
      {Cause::kWarmUpDrift, "warm-up-drift", kPivotObject,
       {{"amplitude_urad", kEvenSigned, 10.0, 100.0}, {"time_constant_s", kEven, 300.0, 1800.0}}},
      {Cause::kServoLagMismatch, "servo-lag-mismatch", kPairObject,
       {{"delay_ms", kEvenSigned, 0.1, 2.0}}},
      {Cause::kServoLag, "servo-lag", kAxisObject, {{"delay_ms", kEven, 0.1, 2.0}}},
      {Cause::kReversalSpike, "reversal-spike", kAxisObject,
       {{"height_um", kEven, 1.0, 8.0}, {"decay_mm", kEven, 0.3, 3.0}}},
      {Cause::kLoadCoupling, "load-coupling", kPairObject,
       {{"coefficient_nm_per_mm2", kEvenSigned, 0.3, 4.0}}},
      {Cause::kVibration, "vibration", kAxisObject,
       {{"frequency_hz", kUniform, 3.0, 40.0}, {"amplitude_um", kEven, 0.05, 1.0}}},
      // Probe geometry and response.
      {Cause::kProbeGain, "probe-gain", kProbeObject, {{"delta", kEvenSigned, 0.002, 0.05}}},
      {Cause::kProbeNonlinearity, "probe-nonlinearity", kProbeObject,
       {{"quadratic_per_mm", kEvenSigned, 0.1, 2.0}}},
      {Cause::kProbePosition, "probe-position", kProbeObject,
       {{"du_mm", kEvenSigned, 0.02, 0.3}, {"dv_mm", kEvenSigned, 0.02, 0.3}}},
      {Cause::kFixtureMisalignment, "fixture-misalignment", kHeadObject,
       {{"roll_urad", kEvenSigned, 500.0, 3000.0},
        {"pitch_urad", kEvenSigned, 500.0, 3000.0},
        {"yaw_urad", kEvenSigned, 500.0, 3000.0},
        {"du_mm", kEvenSigned, 0.05, 0.3},
        {"ds_mm", kEvenSigned, 0.05, 0.3},
        {"dn_mm", kEvenSigned, 0.05, 0.3}}},
      {Cause::kProbeTiltResponse, "probe-tilt-response", kHeadObject,
       {{"electrode_radius_mm", kUniform, 1.0, 5.0}}},
      {Cause::kProbeCrosstalk, "probe-crosstalk", kProbePairObject,
       {{"coefficient", kEvenSigned, 0.002, 0.05}}},
      {Cause::kTargetForm, "target-form", kFaceObject, {{"rms_um", kEven, 0.05, 0.5}}},
      {Cause::kChannelSwap, "channel-swap", kProbePairObject, {}},
      {Cause::kChannelSign, "channel-sign", kProbeObject, {}},
      {Cause::kMainsPickup, "mains-pickup", kProbeObject,
       {{"frequency_hz", kEither, 50.0, 60.0}, {"amplitude_um", kEven, 0.03, 0.5}, kPhase}},
      // Linkage.
      {Cause::kEncoderEccentricity, "encoder-eccentricity", kPivotObject,
       {{"sin_urad", kEvenSigned, 20.0, 200.0}, {"cos_urad", kEvenSigned, 20.0, 200.0}}},
      {Cause::kEncoderSubdivision, "encoder-subdivision", kPivotObject,
       {{"order", kWhole, 8.0, 64.0},
        {"sin_urad", kEvenSigned, 3.0, 40.0},
        {"cos_urad", kEvenSigned, 3.0, 40.0}}},
      {Cause::kEncoderCountSlip, "encoder-count-slip", kPivotObject,
       {{"time_s", kInstant}, {"angle_urad", kEvenSigned, 20.0, 200.0}}},
      {Cause::kBearingRoundness, "bearing-roundness", kPivotObject,
       {{"sin2_um", kEvenSigned, 1.0, 10.0},
        {"cos2_um", kEvenSigned, 1.0, 10.0},
        {"sin3_um", kEvenSigned, 1.0, 10.0},
        {"cos3_um", kEvenSigned, 1.0, 10.0}}},
      {Cause::kLinkThermalGrowth, "link-thermal-growth", kLinkObject,
       {{"coefficient_ppm_per_c", kEvenSigned, 2.0, 20.0}}, true},
      {Cause::kLinkGravityBend, "link-gravity-bend", kPivotObject,
       {{"compliance_urad", kEven, 20.0, 300.0}}},
      {Cause::kJointHysteresis, "joint-hysteresis", kPivotObject,
       {{"width_urad", kEven, 5.0, 60.0}}},
      {Cause::kCapFriction, "cap-friction", kCapObject, {{"displacement_um", kEven, 0.5, 5.0}}},
      // Timing and data.
      {Cause::kClockSkew, "clock-skew", kSourceObject, {{"delay_ms", kEvenSigned, 0.3, 10.0}}},
      {Cause::kStuckChannel, "stuck-channel", kChannel, {kFrom, kTo}},
      {Cause::kOutliers, "outliers", kChannel, {{"count", kWhole, 3.0, 30.0}}},
      // Outside the catalogue of causes.
      {Cause::kUnknownHum, "unknown-hum", kProbeObject,
       {{"amplitude_um", kEven, 0.1, 1.0}, {"period_s", kUniform, 35.0, 45.0}, kPhase},
       false, "time_s"},
      {Cause::kUnknownStepAndBack, "unknown-step-and-back", kProbeObject,
       {{"height_um", kEvenSigned, 0.2, 2.0}, kFrom, kTo}, false, "time_s"},
      {Cause::kUnknownWarmthSquare, "unknown-warmth-square", kProbeObject,
       {{"height_um", kEvenSigned, 0.2, 2.0}}, true, "sensor"},
      {Cause::kUnknownIdleAxis, "unknown-idle-axis", kProbeObject,
       {{"axis", kWhole, 1.0, 3.0},
        {"amplitude_um", kEven, 0.3, 3.0},
        {"period_mm", kUniform, 0.15, 0.3}},
       false, "axis"},
      {Cause::kUnknownFeedSquare, "unknown-feed-square", kAxisObject,
       {{"height_um", kEvenSigned, 2.0, 15.0}}, false, "feed_mm_min"},
      {Cause::kUnknownDiagonalRipple, "unknown-diagonal-ripple", kPairObject,
       {{"amplitude_um", kEven, 1.0, 8.0}, {"period_mm", kUniform, 7.0, 12.0}, kPhase}, false,
       "sum"},
      {Cause::kUnknownAngleBump, "unknown-angle-bump", kPivotObject,
       {{"height_urad", kEvenSigned, 15.0, 120.0},
        {"centre_rad", kTurn},
        {"width_rad", kUniform, 0.01, 0.03}},
       false, "angle"},
      {Cause::kUnknownWander, "unknown-wander", kPivotObject,
       {{"deviation_urad", kEven, 10.0, 80.0}, {"time_constant_s", kEven, 60.0, 600.0}}, false,
       "time_s"},
  };
  return entries;
}

}  // namespace abbe::rig
