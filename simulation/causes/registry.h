// All known causes, in the order in which reports list them.
//
// A new cause: one file that defines a function like those below, its line here and in
// registry.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "simulation/causes/cause.h"

namespace abbe::simulation {

Cause Backlash();
Cause LeadscrewCyclic();
Cause ScaleError();
Cause Squareness();
Cause ThermalGrowth();
Cause WarmUpDrift();
Cause PivotWarmUp();
Cause ServoLag();
Cause ServoLagMismatch();
Cause ReversalSpike();
Cause LoadCoupling();
Cause Vibration();
Cause ProbeGain();
Cause ProbeNonlinearity();
Cause ProbePosition();
Cause ProbeTiltResponse();
Cause ProbeCrosstalk();
Cause TargetForm();
Cause ChannelSwap();
Cause ChannelSign();
Cause MainsPickup();
Cause EncoderEccentricity();
Cause EncoderSubdivision();
Cause EncoderCountSlip();
Cause BearingRoundness();
Cause LinkThermalGrowth();
Cause LinkGravityBend();
Cause JointHysteresis();
Cause JointGain();
Cause CapFriction();
Cause CapTrailing();
Cause ClockSkew();
Cause FixtureMisalignment();
Cause TargetEccentricity();
Cause TargetLobing();
Cause ShaftErrorMotion();
Cause SensorGain();
Cause SensorNonlinearity();
Cause ShaftClockSkew();
Cause StuckChannel();
Cause Outliers();

const std::vector<Cause>& Causes();

// InputError that names the nearest known cause.
const Cause& CauseNamed(const std::string& id);

}  // namespace abbe::simulation
