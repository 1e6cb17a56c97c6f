// The machine before anything of it was measured: which forms its error functions may take, and
// what is known of them.
//
//   const machine::VolumetricModel model = UnknownMachine(mill);
//   const MachinePrior prior(mill, model, 0.015);              // correlation length, m
//
// Each function is a Gaussian process over its axis with the standard deviation of the population
// in the machine file and covariance sd^2 exp(-(d / smoothness)^2 / 2); a positioning error has a
// random slope (scale) besides. It is projected on a cubic B-spline with knots half a correlation
// length apart, which keeps it to 0.01 % of sd; the gauge of machine/error_function.h then takes
// the value at the reference and the slope of a straightness off. Units: SI. Shapes: covariance n x
// n of the coefficients of a function. Failure: InputError for a correlation length that is not
// above 0. Source: Rasmussen and Williams, Gaussian Processes (2006), 2.2 and 4.2.
#pragma once

#include <Eigen/Core>

#include "estimation/problem.h"
#include "machine/machine.h"
#include "machine/volumetric_model.h"

namespace abbe::fusion {

machine::VolumetricModel UnknownMachine(const machine::Machine& machine);

class MachinePrior {
 public:
  MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
               double smoothness);

  double smoothness() const { return smoothness_; }
  Eigen::MatrixXd Covariance(int axis, int motion) const;
  // W with W' W the inverse of the covariance; directions that the prior hardly allows keep a
  // three-thousandth of its largest deviation.
  Eigen::MatrixXd Whitening(int axis, int motion) const;

 private:
  machine::Machine machine_;
  std::array<std::array<Eigen::Index, machine::kMotions>, machine::kAxes> sizes_;
  double smoothness_;
};

}  // namespace abbe::fusion
