// All effects that the rig can hide.
//
// A new effect: one file that defines its function, and its line here. Warm-up has a line for each
// kind of its objects, because its sizes have other units there.
#pragma once

#include <vector>

#include "rig/effects/effect.h"

namespace abbe::rig {

// clang-format off
#define ABBE_HIDDEN_EFFECTS(EFFECT) \
  EFFECT(Backlash) \
  EFFECT(VaryingBacklash) \
  EFFECT(StandingPosition) \
  EFFECT(LeadscrewCyclic) \
  EFFECT(ScaleError) \
  EFFECT(Squareness) \
  EFFECT(ThermalGrowth) \
  EFFECT(WarmUpOfAxis) \
  EFFECT(WarmUpOfProbe) \
  EFFECT(WarmUpOfPivot) \
  EFFECT(ServoLagMismatch) \
  EFFECT(ServoLag) \
  EFFECT(ReversalSpike) \
  EFFECT(LoadCoupling) \
  EFFECT(Vibration) \
  EFFECT(ProbeGain) \
  EFFECT(ProbeNonlinearity) \
  EFFECT(ProbePosition) \
  EFFECT(FixtureMisalignment) \
  EFFECT(ProbeTiltResponse) \
  EFFECT(ProbeCrosstalk) \
  EFFECT(TargetForm) \
  EFFECT(ChannelSwap) \
  EFFECT(ChannelSign) \
  EFFECT(MainsPickup) \
  EFFECT(EncoderEccentricity) \
  EFFECT(EncoderSubdivision) \
  EFFECT(EncoderCountSlip) \
  EFFECT(BearingRoundness) \
  EFFECT(LinkThermalGrowth) \
  EFFECT(LinkGravityBend) \
  EFFECT(JointHysteresis) \
  EFFECT(CapFriction) \
  EFFECT(ClockSkew) \
  EFFECT(StuckChannel) \
  EFFECT(Outliers) \
  EFFECT(UnknownHum) \
  EFFECT(UnknownStepAndBack) \
  EFFECT(UnknownWarmthSquare) \
  EFFECT(UnknownIdleAxis) \
  EFFECT(UnknownFeedSquare) \
  EFFECT(UnknownDiagonalRipple) \
  EFFECT(UnknownAngleBump) \
  EFFECT(UnknownWander)
// clang-format on

namespace effects {
#define ABBE_DECLARE_EFFECT(name) Effect name();
ABBE_HIDDEN_EFFECTS(ABBE_DECLARE_EFFECT)
#undef ABBE_DECLARE_EFFECT
}  // namespace effects

// In this order; effects of one name stand together.
const std::vector<Effect>& EffectCatalogue();

}  // namespace abbe::rig
