// How well the runs determine each error of the machine, and by which kinds of run.
//
//   const SeenErrors seen = SeeErrors(machine, model, runs, columns, at);
//   seen.functions[4].determined_by;            // {"sweep", "linkage"}; empty: prior only
//
// A kind of run determines a function when it alone at least halves the function's prior variance
// over the travel. A linkage of unknown link lengths cannot see the isotropic scale, the mean slope
// of EXX, EYY and EZZ: it is calibrated when the data at least halve its prior variance, else
// "prior only".
// Units: SI. Shapes: 21 functions in the order of map/error_map.h.
// Failure: none.
// Source: docs/theory-fusion.md.
// Validity: first order at the estimate; a half is a convention, and a function just above it is
// not much worse known.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/linearization.h"
#include "machine/machine.h"
#include "machine/volumetric_model.h"
#include "simulation/simulated_run.h"

namespace abbe::fusion {

struct FunctionSeen {
  std::string name;                        // "EXX" ... "ECZ", then "A0Z", "B0Z", "C0Y"
  double prior = 0.0;                      // rms standard uncertainty over the travel, m or rad:
  double u = 0.0;                          // of the prior, and with the data
  std::vector<std::string> determined_by;  // kinds of runs, the best first
};

struct ScaleSeen {
  double value = 0.0, u = 0.0, prior = 0.0;  // relative
  bool calibrated = false;
};

struct SeenErrors {
  std::vector<FunctionSeen> functions;
  ScaleSeen scale;
  Eigen::MatrixXd covariance;  // of the parameters of the model
};

// `model` with the values found; `columns`: where its parameters stand in `at`, the problem
// linearised at its solution, whose first sources are the runs and whose last is the prior of the
// functions.
SeenErrors SeeErrors(const machine::Machine& machine, const machine::VolumetricModel& model,
                     const std::vector<simulation::SimulatedRun>& runs,
                     const std::vector<int>& columns, const estimation::Linearization& at);

}  // namespace abbe::fusion
