// The machine as its file describes it: name, chain, axis travels, reference point and the
// population of machines that its errors come from.
//
//   const auto document = settings::Document::Read("machine.toml");
//   const machine::Machine mill = machine::ReadMachine(document.Root());
//
// Frame: M, the machine frame, right-handed, along the axes X, Y, Z. The error motions of an axis
// act at the reference point, which travels with the carriage and is named by where it stands with
// all axes at zero. SI units. Every key stands in docs/machine-file.md.
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

// How far beyond the travel the soft limits lie where the machine file does not say.
inline constexpr double kBeyondTravel = 0.1e-3;  // m

std::array<Travel, 3> AroundTravels(const std::array<Travel, 3>& travels);

// The position itself, or the end of the travel where only rounding puts it beyond (16 eps).
// InputError names the axis 0, 1, 2 and its travel: nothing is known outside it.
double InTravel(const Travel& travel, int axis, double position);

// Standard deviations of the errors of machines of this kind. An error function over an axis is a
// stationary Gaussian process with this standard deviation and correlation length `smoothness`.
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
  Chain chain;                    // with the way in which the control counts
  Eigen::Vector3d reference;      // m, in M
  std::array<Travel, 3> travels;  // of X, Y, Z: where the errors are known
  std::array<Travel, 3> limits;   // the soft limits, which hold the travels
  Population population;
};

// Reads `name`, `chain`, `reference_mm`, `[axis.*]` and `[population]`. Keys of the root that
// belong to other readers are left alone; whoever has run all readers calls root.RefuseUnknown().
// InputError with file, line and key.
Machine ReadMachine(const settings::Table& root);

// Of a file that describes an arm and no axes: reads `name`; no travel, chain "[w b X Y Z t]".
Machine ReadMachineWithoutAxes(const settings::Table& root);

}  // namespace abbe::machine
