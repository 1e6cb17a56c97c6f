// All known causes, in the order in which reports list them.
//
// A new cause: one file that defines its function, and its line here.
// Units: none.
// Failure: InputError for an unknown name.
// Source: docs/causes.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "simulation/causes/cause.h"

namespace abbe::simulation {

// clang-format off
#define ABBE_CAUSES(CAUSE) \
  CAUSE(Backlash) \
  CAUSE(VaryingBacklash) \
  CAUSE(StandingPosition) \
  CAUSE(LeadscrewCyclic) \
  CAUSE(ScaleError) \
  CAUSE(Squareness) \
  CAUSE(ThermalGrowth) \
  CAUSE(WarmUpDrift) \
  CAUSE(PivotWarmUp) \
  CAUSE(ServoLag) \
  CAUSE(ServoLagMismatch) \
  CAUSE(ReversalSpike) \
  CAUSE(LoadCoupling) \
  CAUSE(Vibration) \
  CAUSE(ProbeGain) \
  CAUSE(ProbeNonlinearity) \
  CAUSE(ProbePosition) \
  CAUSE(ProbeTiltResponse) \
  CAUSE(ProbeCrosstalk) \
  CAUSE(TargetForm) \
  CAUSE(ChannelSwap) \
  CAUSE(ChannelSign) \
  CAUSE(MainsPickup) \
  CAUSE(EncoderEccentricity) \
  CAUSE(EncoderSubdivision) \
  CAUSE(EncoderCountSlip) \
  CAUSE(BearingRoundness) \
  CAUSE(LinkThermalGrowth) \
  CAUSE(LinkGravityBend) \
  CAUSE(JointHysteresis) \
  CAUSE(JointGain) \
  CAUSE(JointCompliance) \
  CAUSE(ArmDrift) \
  CAUSE(LateReading) \
  CAUSE(CapFriction) \
  CAUSE(CapTrailing) \
  CAUSE(ClockSkew) \
  CAUSE(FixtureMisalignment) \
  CAUSE(TargetEccentricity) \
  CAUSE(TargetLobing) \
  CAUSE(ShaftErrorMotion) \
  CAUSE(SensorGain) \
  CAUSE(SensorNonlinearity) \
  CAUSE(ShaftClockSkew) \
  CAUSE(StuckChannel) \
  CAUSE(Outliers)
// clang-format on

#define ABBE_DECLARE_CAUSE(name) Cause name();
ABBE_CAUSES(ABBE_DECLARE_CAUSE)
#undef ABBE_DECLARE_CAUSE

// Made once.
const std::vector<Cause>& Causes();

// InputError that names the nearest known cause.
const Cause& CauseNamed(const std::string& id);

}  // namespace abbe::simulation
