// Error motions that differ between the two directions of an axis, as parameters of its runs.
//
//   for (auto& run : runs) WithReversals(machine, run);           // blocks "reversal X", ...
//   JudgeReversals(machine, fit, runs);      // as large as the runs say, or held at nothing
//   ReversalsOf(fit, 1.0);                   // {"EBX", -13.2e-6, 0.1e-6, true}
//
// The map is the mean of both directions (ISO 230-1: bidirectional mean): an axis that reverses by
// r has half of it more going forward (+) and half less going backward. Each axis that moves both
// ways in some run has six such numbers. They are draws of one size over what the machine file
// states of that error, of which the marginal likelihood is the greatest; an axis whose runs do not
// tell (odds below 1000 : 1) has none.
// Units: m, rad.
// Failure: none; runs that do not know which way an axis moved stay as they are.
// Source: ISO 230-1 and ISO 230-2 for the reversal error, forward minus backward.
// Validity: one number along the whole axis; directions as each row's run knows them
// (simulation/simulated_run.h).
#pragma once

#include <string>
#include <vector>

#include "estimation/result.h"
#include "machine/machine.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

// As large as a third of the errors of the machine file, to be judged after a first fit.
void WithReversals(const machine::Machine& machine, simulation::SimulatedRun& run);

// What became of those of the fit, the least change first; kNone: they were hardly there, and are
// held at nothing.
enum class Judged { kAsBefore, kNone, kOtherSize };
Judged JudgeReversals(const machine::Machine& machine, const estimation::Result& fit,
                      std::vector<simulation::SimulatedRun>& runs);

struct Reversal {
  std::string name;  // "EBX"
  double value, u;   // forward minus backward, m or rad; standard uncertainty
  bool rotates;
};
// Those beyond chance (0.05 % each). `widened`: times, every uncertainty (fuse.h).
std::vector<Reversal> ReversalsOf(const estimation::Result& fit, double widened);

bool IsReversal(const estimation::ParameterBlock& block);

}  // namespace abbe::fusion
