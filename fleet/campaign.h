// What the runs of one campaign tell of the errors of a machine, free of any prior of these.
//
// Units: SI. Shapes: H n x n and h n x 1, n the parameters of
// UnknownMachine(machine, KnotsOf(machine)).
// Failure: none. Source: fusion/population_estimate.h. Validity: to first order.
#pragma once

#include <array>
#include <string>

#include "fusion/population_evidence.h"

namespace abbe::fleet {

struct Campaign {
  std::string machine, name;  // whose it is said to be; "A12", "a12-spring"
  fusion::Quadratic seen;
};

// The knots of the model of a type, m apart: a quarter of the correlation length of the machine file,
// so that a fleet may be twice as rough as that says.
inline std::array<double, machine::kAxes> KnotsOf(const machine::Machine& machine) {
  std::array<double, machine::kAxes> knots = fusion::KnotsOf(machine);
  for (double& each : knots) each *= 0.5;
  return knots;
}

}  // namespace abbe::fleet
