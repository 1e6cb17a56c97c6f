// The form of the faces of the target as numbers that all sweeps of one axis share.
//
//   const FormOfTarget form = FormOfTargetIn(chain, instrument, run);
//   gap += form.columns * heights;      // the entries of form.blocks, m
//
// A form of one standard deviation that correlates by exp(-d^2 / (2 l^2)) is made of humps along
// the sweep, at places u_j = 0.8 j l that belong to the face and not to the recording, and of the
// lines across on which the probes of a unit pass it:
//
//   form(u, line i) = sum over j, k of w_jk g(u - u_j) / |g(u)| L_ik      g(u) = exp(-u^2 / l^2)
//
// w independent, L L' the covariance of the lines: those of the head as it is made, then those that
// it passes when target or head is reversed. A block is one w, "target_form X top 0 -3.height",
// with target.form as its standard deviation. The side unit of a turned head sees another face.
// Frames: target_spots.h. Units: m. Shapes: rows probe by probe, all rows of a, then of b, ...
// Failure: none; without blocks where no form is stated, or where it is so short beside the travel
// that it takes more than 200 humps (the form of a travel above 160 l is noise).
// Source: Higdon, "Space and space-time modeling using process convolutions" (2002).
// Validity: variances are exact, correlations to 0.002; humps leave 1 % of a form out, which is as
// much as noise; one target, placed to some tenths of l.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/parameter.h"
#include "machine/chain.h"
#include "simulation/sweep/sweep_simulation.h"

namespace abbe::simulation {

struct FormOfTarget {
  std::vector<estimation::ParameterBlock> blocks;
  Eigen::MatrixXd columns;  // not whitened
};

// As one sweep sees it.
FormOfTarget FormOfTargetIn(const machine::Chain& chain, const SweepInstrument& instrument,
                            const SweepRun& run);

}  // namespace abbe::simulation
