// A machine as described in its file: name, chain, axis travels, reference point and the prior of
// its errors.
//
//   const auto document = settings::Document::Read("machine.toml");
//   const machine::Machine mill = machine::ReadMachine(document.Root());
//
// Frame: M, the machine frame, right-handed, along the axes X, Y, Z. The error motions of an axis
// act at the reference point, which moves with the carriage; `reference` is its position with all
// axes at zero.
// Units: SI. docs/machine-file.md lists every key. Shapes: travels, limits and positions in the
// order X, Y, Z.
// Failure: InputError with file, line and key; outside a travel with axis and travel.
// Source: own; the prior is a Gaussian process with squared-exponential correlation
// (fusion/machine_prior.h).
// Validity: linear axes X, Y, Z; the errors do not change over the run but by the causes of a
// diagnosis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "machine/chain.h"
#include "settings/document.h"

namespace abbe::machine {

// 0, 1, 2 for 'X', 'Y', 'Z'; InputError for any other letter.
int AxisIndex(char axis);

struct Travel {
  double first;  // m, as the control counts
  double last;   // m, above first
};

// Distance of the soft limits beyond the travel unless the machine file states them.
inline constexpr double kBeyondTravel = 0.1e-3;  // m

// The travels, widened by kBeyondTravel at both ends.
std::array<Travel, 3> AroundTravels(const std::array<Travel, 3>& travels);

// The position, or the end of the travel if it is beyond it by rounding only (16 eps). InputError
// outside the travel of the axis (0, 1, 2), where the errors are not known.
double InTravel(const Travel& travel, int axis, double position);

// The prior of the errors: their standard deviations over the population of such machines. An error
// function is a stationary Gaussian process with this standard deviation and the correlation length
// `smoothness`.
struct Population {
  double positioning;   // m: EXX
  double straightness;  // m: EYX, EZX
  double roll;          // rad: EAX
  double pitch;         // rad
  double yaw;           // rad
  double squareness;    // rad: A0Z, B0Z, C0Y
  double scale;         // relative: slope of EXX
  double smoothness;    // m
};

// The standard deviation of one of the 18 error functions: m or rad.
double PopulationDeviation(const Population& population, int axis, int motion);

struct Machine {
  std::string name;
  Chain chain;                    // with the sign of the positions
  Eigen::Vector3d reference;      // m, in M
  std::array<Travel, 3> travels;  // of X, Y, Z: where the errors are known
  std::array<Travel, 3> limits;   // the soft limits, which contain the travels
  Population population;
};

// Reads `name`, `chain`, `reference_mm`, `[axis.*]` and `[population]`. Other keys of the root are
// ignored; the caller calls root.RefuseUnknown() after all readers. InputError with file, line and
// key.
Machine ReadMachine(const settings::Table& root);

// For a file that describes an arm without axes: reads `name` and `[population]`; the travels are
// empty and the chain is "[w b X Y Z t]".
Machine ReadMachineWithoutAxes(const settings::Table& root);

}  // namespace abbe::machine
