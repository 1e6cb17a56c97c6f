// Compares two forms of the error functions by held-out holes of a plate: the B-spline of the fit
// and the neural network of Ha and Khanh.
//
//   const auto checks = CompareInterpolators(mill, smoothness, setups, 4);
//   const machine::VolumetricModel networks =
//       AsNetworks(model, StationsOf(setups), machine::NetworkBias::kWithBias, nullptr);
//
// Every `folds`-th hole is left out in turn, in all set-ups; the rest is fitted, with B-splines. As
// in the paper, a network then learns each error function from its values at the stations, the axis
// positions of the holes. It has one hidden layer of tanh and grows by one neuron until its rms is
// 1 um or less (of an angle: at the longest travel) or kMostNeurons is reached. Each size is
// trained in at most kMostCycles steps, under weak priors that bound its weights.
// Frames: the plate's own plane, in which hole and fit are compared.
// Units: m. Shapes: one check a form.
// Failure: InputError when too few holes are left in a set-up to lay the plate.
// Source: Ha and Khanh, "An application of neural network in calibration of coordinate measuring
// machines" (2011), section 4: equations 22 and 23, stop at RMS <= 1 um or N cycles; there trained
// by gradient descent.
// Validity: for the plate and its set-ups; says nothing of positions between the holes.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "machine/machine.h"
#include "machine/tanh_network.h"
#include "machine/volumetric_model.h"
#include "simulation/points/plate_simulation.h"

namespace abbe::fusion {

inline constexpr double kLearned = 1e-6;  // m, rms
inline constexpr int kMostNeurons = 6;
inline constexpr int kMostCycles = 200;

// The largest values over all functions.
struct Learning {
  double rms = 0.0;  // m
  int cycles = 0;
  int neurons = 0;
};

// Every error function of `model` as a network. `stations`: of each axis, m. Functions below 1 pm
// or 1 prad everywhere become zero.
machine::VolumetricModel AsNetworks(const machine::VolumetricModel& model,
                                    const std::array<std::vector<double>, machine::kAxes>& stations,
                                    machine::NetworkBias bias, Learning* learning);

// The axis positions of the holes; where there are many, evenly chosen ones.
std::array<std::vector<double>, machine::kAxes> StationsOf(
    const std::vector<simulation::PlateSetup>& setups);

struct InterpolatorCheck {
  std::string name;       // "b-spline", "network", "network with bias"
  double held_out = 0.0;  // m: rms distance of a hole in the plate, mean of the folds
  Learning learning = {};
};

// `folds` fits; `smoothness` m.
std::vector<InterpolatorCheck> CompareInterpolators(
    const machine::Machine& machine, double smoothness,
    const std::vector<simulation::PlateSetup>& setups, int folds);

}  // namespace abbe::fusion
