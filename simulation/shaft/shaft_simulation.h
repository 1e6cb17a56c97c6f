// What gap sensors round a turning shaft should read: nothing but their zero, for the shaft is
// round, centred and turns about a fixed axis until a cause (simulation/causes/) says otherwise.
//
//   const SimulatedRun simulated = SimulateShaft(run);
//   const Trace trace = TraceOf(recording, run);                      // kind "shaft"
//
//   residual = (gap - zero of the sensor) / sd of the sensor
//
// Unknowns: "rim_zero RUN" [sensor_1 ...], of which nothing is known. Disturbances act at the
// reading stages (simulation/disturbance.h), sensor_1 at the first; the machine has no part in it.
// Frames: none; gaps along the look of each sensor.
// Units: m. Shapes: one row a reading.
// Failure: InputError with the recording's name for a run without noise.
// Source: docs/shaft.md.
// Validity: small against the radius; the shaft's own error motion and the rim's form are causes,
// not parameters.
#pragma once

#include "recording/recording.h"
#include "simulation/shaft/shaft_run.h"
#include "simulation/simulated_run.h"
#include "simulation/trace.h"

namespace abbe::simulation {

// Zeros only are free.
SimulatedRun SimulateShaft(const ShaftRun& run);

// With the part `rim`.
Trace TraceOf(const recording::Recording& recording, const ShaftRun& run);

}  // namespace abbe::simulation
