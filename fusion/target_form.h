// The form of the target as parameters that all sweeps of an axis share, in place of noise.
//
//   WithForm(run);          // adds the blocks "target_form X top 0 -3", ..., before WithReversals
//   SetForm(3.0, run);      // three times as much form as stated
//
// The noise of a sweep contains the form that the file states: right for one sweep, and wrong for
// several, in which it is the same. As parameters it is one form for all of them. In a single
// mounting it cannot be separated from the straightness and the angles of the axis, however often
// that is swept, and their uncertainty keeps it; a target that is shifted or reversed, and runs
// that see these errors otherwise, tell the two apart.
// Units: m. Shapes: one block of one entry for each place (simulation/sweep/form_of_target.h).
// Failure: none; runs without a target, or whose file states no form, stay as they are.
// Source: simulation/sweep/form_of_target.h.
// Validity: one target for all sweeps, whatever its mounting.
#pragma once

#include "estimation/parameter.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

// Adds the form as parameters of a sweep.
void WithForm(simulation::SimulatedRun& run);
// Lets the form be k times what the file states.
void SetForm(double k, simulation::SimulatedRun& run);

// Whether a block of parameters is such a form.
bool IsForm(const estimation::ParameterBlock& block);

}  // namespace abbe::fusion
