// The prior of a machine's error functions: their form and their covariance before any measurement.
//
//   const machine::VolumetricModel model = UnknownMachine(mill);
//   const MachinePrior prior(mill, model, PopulationOf(mill));
//
// Each function is a Gaussian process over its axis with a standard deviation and a correlation
// length of its own, those of the machine file unless the runs say otherwise
// (population_estimate.h): covariance sd^2 exp(-(d / length)^2 / 2); a positioning error has a
// random slope (scale) besides. It is projected on a quintic B-spline; with knots half a
// correlation length apart that represents it to 0.02 % of sd (rms). The gauge of
// machine/error_function.h then removes the value at the reference and the slope of a straightness.
//
// A positioning error may have waves besides, of screw, gear or scale, shorter than the smooth
// error: a second process of the same kind, on knots of 0.5 mm (or 160 coefficients, on a long
// axis). What runs leave open between their places is then as uncertain as such waves are large.
// Units: SI. Shapes: covariance n x n of the coefficients of a function.
// Failure: InputError for a correlation length that is not above 0.
// Source: Rasmussen and Williams, Gaussian Processes (2006), 2.2 and 4.2.
// Validity: errors that vary alike along the travel; a step or a period in an error is improbable
// under it and shows in a diagnosis. Waves below a millimetre look like noise of the places.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "estimation/problem.h"
#include "machine/machine.h"
#include "machine/volumetric_model.h"

namespace abbe::fusion {

// Size and correlation length of each error function; sizes of the squarenesses and of the slopes
// of the positioning errors. One standard deviation each.
struct ErrorPopulation {
  using OfFunctions = Eigen::Array<double, machine::kAxes, machine::kMotions>;
  OfFunctions deviation;  // m or rad
  OfFunctions length;     // m
  double squareness;      // rad
  double scale;           // relative
  // Waves of the positioning errors, which are shorter: sizes and correlation lengths, m.
  Eigen::Array3d wave = Eigen::Array3d::Zero();
  Eigen::Array3d wave_length = Eigen::Array3d::Ones();
};

// As the machine file says.
ErrorPopulation PopulationOf(const machine::Machine& machine);

// All error functions zero, with B-splines of knots half the correlation length of the machine file
// apart, or at most as far apart as stated for each axis, m.
machine::VolumetricModel UnknownMachine(const machine::Machine& machine);
machine::VolumetricModel UnknownMachine(const machine::Machine& machine,
                                        const std::array<double, machine::kAxes>& knots);
// The same with finer knots of the positioning errors of these axes, so that they hold waves.
machine::VolumetricModel WithWaves(machine::VolumetricModel model,
                                   const std::array<bool, machine::kAxes>& axes);
bool HoldsWaves(const machine::VolumetricModel& model, int axis);
// The sizes and lengths of waves that are usual, m.
inline constexpr double kUsualWave = 1e-6, kUsualWaveLength = 1e-3;

// As far apart as the shortest correlation length of each axis asks for, m, but not finer than a
// twelfth of that of the machine file; `knots` where these do.
std::array<double, machine::kAxes> KnotsFor(const machine::Machine& machine,
                                            const ErrorPopulation& population,
                                            const std::array<double, machine::kAxes>& knots);
// Half the correlation length of the machine file, m.
std::array<double, machine::kAxes> KnotsOf(const machine::Machine& machine);

class MachinePrior {
 public:
  MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
               const ErrorPopulation& population);
  // One correlation length for all, all else as the machine file says.
  MachinePrior(const machine::Machine& machine, const machine::VolumetricModel& model,
               double smoothness);

  // The same of another population.
  MachinePrior With(const ErrorPopulation& population) const;

  const ErrorPopulation& population() const { return population_; }
  // The covariance of a function of deviation 1 without its slope, and its derivative by the
  // logarithm of the correlation length.
  struct Unit {
    Eigen::MatrixXd covariance, by_length;
  };
  // `motion` 0 to 5 of `axis` 0 to 2.
  Unit UnitCovariance(int axis, int motion) const;
  // The same of a wave.
  Unit UnitWave(int axis) const;
  // The part of the coefficients of a positioning error that is its wave: their best estimate is M
  // times the coefficients. Empty where the function holds none.
  Eigen::MatrixXd PartOfWave(int axis) const;
  // That of a random slope of standard deviation 1.
  Eigen::MatrixXd UnitSlope(int axis) const;

  // The standard deviations along the axes of the covariance of a function, which are the columns
  // of `axes`. Eigenvalues below 1e-7 of the largest are raised to that.
  struct Spread {
    Eigen::MatrixXd axes;
    Eigen::VectorXd deviations;
  };
  // The whole covariance, slope included.
  Spread SpreadOf(int axis, int motion) const;
  // W with W' W the inverse of the covariance.
  Eigen::MatrixXd Whitening(int axis, int motion) const;
  // The logarithm of the determinant of the whitening of all functions.
  double LogWhitening() const;

 private:
  struct Projected {
    Eigen::VectorXd x;     // points on the axis
    Eigen::MatrixXd onto;  // from values there to coefficients
    Eigen::VectorXd line;  // coefficients of a slope of 1
  };

  const Projected& On(int axis, int motion) const { return (*axes_)[axis][motion == axis]; }
  Unit UnitOf(const Projected& on, double length) const;

  using OfAxes = std::array<std::array<Projected, 2>, machine::kAxes>;  // positioning second
  std::shared_ptr<const OfAxes> axes_;
  ErrorPopulation population_;
};

}  // namespace abbe::fusion
