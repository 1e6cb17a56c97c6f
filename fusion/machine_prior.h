// The prior of a machine's error functions: their form and their covariance before any measurement.
//
//   const machine::VolumetricModel model = UnknownMachine(mill);
//   const MachinePrior prior(mill, model, 0.015);              // correlation length, m
//
// Each function is a Gaussian process over its axis with the standard deviation of the population
// in the machine file and covariance sd^2 exp(-(d / smoothness)^2 / 2); a positioning error has a
// random slope (scale) besides. It is projected on a quintic B-spline with knots half a correlation
// length apart, which represents it to 0.02 % of sd (rms); the gauge of machine/error_function.h
// then removes the value at the reference and the slope of a straightness. Units: SI. Shapes:
// covariance n x n of the coefficients of a function. Failure: InputError for a correlation length
// that is not above 0. Source: Rasmussen and Williams, Gaussian Processes (2006), 2.2 and 4.2.
#pragma once

#include <Eigen/Core>

#include "estimation/problem.h"
#include "machine/machine.h"
#include "machine/volumetric_model.h"

namespace abbe::fusion {

// All error functions zero, with B-splines for the correlation length of the machine file.
machine::VolumetricModel UnknownMachine(const machine::Machine& machine);

class MachinePrior {
 public:
  MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
               double smoothness);

  double smoothness() const { return smoothness_; }
  Eigen::MatrixXd Covariance(int axis, int motion) const;
  // W with W' W the inverse of the covariance, whose eigenvalues below 1e-7 of the largest are
  // raised to that.
  Eigen::MatrixXd Whitening(int axis, int motion) const;

 private:
  machine::Machine machine_;
  std::array<std::array<Eigen::Index, machine::kMotions>, machine::kAxes> sizes_;
  double smoothness_;
};

}  // namespace abbe::fusion
