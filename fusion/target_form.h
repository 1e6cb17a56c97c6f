// A target that is less flat than the machine file says, as parameters of a sweep.
//
//   WithForm(run);                        // adds the block "target_form sweep_X.csv"
//   SetForm(3.0, run);                    // three times as much form as stated, in all
//
// The noise of a sweep contains the form that the file states. The block adds independent draws
// with the standard deviation sqrt(k^2 - 1) for a target of k times that form. Each sweep has a
// form of its own. In a single mounting it cannot be told from the straightness and the angles of
// the axis; only runs that see these otherwise, or see another part of the target, can tell k.
// Failure: none; runs without a target, or whose file states no form, stay as they are.
#pragma once

#include "estimation/parameter.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

inline constexpr double kHardlyMoreForm = 1.02;  // the least k of a run with such a block

void WithForm(simulation::SimulatedRun& run);
void SetForm(double k, simulation::SimulatedRun& run);

// Whether a block of parameters is such a form.
bool IsForm(const estimation::ParameterBlock& block);

}  // namespace abbe::fusion
