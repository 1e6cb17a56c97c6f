// What a sweep should read: command -> machine -> target and head -> gap -> probe.
//
//   const SimulatedRun run = SimulateSweep(model, reference, instrument, sweep);
//
// The head hangs on the tool body T, the target stands on the workpiece W. All bodies are rigid,
// all rotations full, and the measuring line of each probe is cut with the plane of its face, in W:
//
//   X_WT    = X_MW^-1 X_MT                          carriages of machine/volumetric_error.h
//   p, w    = electrode and direction               T: installed head, at half of the range
//   gap     = m . (corner - X_WT p) / (m . X_WT w)  m the normal of the face, as mounted
//   reading = gain * electrode(gap, tilt) + zero
//
// Unknowns, in this order, with their priors from the machine file:
//   the six functions of the swept axis, squareness          of the machine
//   probe_position   a_u a_s ... e_u e_n, m                   of the head, all sweeps
//   probe_gain       a ... e                                  likewise
//   head_turn AXIS, head_place AXIS                           installation for the axis and
//   mounting target_tilt, target_squareness                            of the target, of the
//   mounting probe_zero RUN   a ... e, m                               nothing known of it
//   step_slope RUN   EXX ... ECZ of the two axes that step, gap steps only: the slope of each of
//                    their error motions at the start
// The zero takes in the height of each electrode, the place of head and faces along their normal
// and the error of the machine at the start, so a sweep says nothing of these.
//
// What a probe departs from its straight characteristic (probes/probe_linearity.h) is in the
// covariance of each run: another run over the same gaps departs on its own.
// The form of the faces is a Gaussian process (target.form); where a probe sees it is nominal. It
// correlates the readings of probes of one face, and is put into the covariance; `form_apart` has
// it as parameters that all sweeps share (form_of_target.h).
//
// Frames: M, W, T of machine/volumetric_error.h; H of probes/head_layout.h.
// Units: m, rad. Shapes: rows probe by probe: all rows of a, then of b, ...
// Failure: InputError for a head without frame for the axis, and for a gap that no electrode can
// read.
// Source: docs/theory-head.md for the readings, docs/theory-fusion.md for the whole.
// Validity: errors of the axes that stand still during the sweep are constant and go into the
// zeros; over gap steps they are straight lines.
#pragma once

#include "machine/volumetric_model.h"
#include "probes/head_settings.h"
#include "simulation/simulated_run.h"
#include "simulation/sweep/sweep_run.h"

namespace abbe::simulation {

struct SweepInstrument {
  probes::HeadSettings head;
  probes::TargetSettings target;
};

// `reference`: the machine's reference point, m, in M. `model` gives the forms of the functions.
SimulatedRun SimulateSweep(const machine::VolumetricModel& model, const Eigen::Vector3d& reference,
                           const SweepInstrument& instrument, const SweepRun& run);

}  // namespace abbe::simulation
