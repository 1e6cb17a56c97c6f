// The error motions of the machine that the seed draws: six functions for each axis, three
// squarenesses.
//
// Population: each function is a stationary Gaussian process (gaussian_field.h) with the standard
// deviation and the correlation length of the machine file. After the draw
//  - every function is shifted to be zero at the axis reference, the end of the travel where the
//    carriage is lowest in M,
//  - a straightness loses the slope of its least-squares line over the full travel (uniform
//    weight), because the slope of an axis is its squareness,
//  - a positioning error gains the slope of the axis's scale error.
//
// Order: [EXX EYX EZX EAX EBX ECX] and alike for Y and Z, m then rad, in the machine frame: for
// every axis entry 0, 1, 2 is the translation along x, y, z and 3, 4, 5 the turn about x, y, z. The
// positioning error has the sign of the axis as the controller counts it (rig_settings.h), the
// other five that of M. The functions are drawn over the position of the carriage in M, so a
// machine whose controller counts the other way has the same errors.
// Squareness: the X line is the primary, the XY plane the secondary: a positive C0Y turns the Y
// line about +z, A0Z and B0Z turn the Z line about +x and +y.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rig/gaussian_field.h"
#include "rig/rig_settings.h"
#include "rig/rotation.h"

namespace abbe::rig {

inline constexpr int kMotions = 6;
using Motions = Eigen::Matrix<double, kMotions, 1>;

// "EYX" of axis 0, motion 1.
std::string MotionName(int axis, int motion);

class AxisErrors {
 public:
  AxisErrors(const RigSettings& settings, int axis, std::uint64_t seed);

  // At a position of the controller, m; defined also outside the travel.
  Motions At(double position) const;
  double scale() const { return scale_; }

  // Adds the errors of another axis of the same travel and correlation length.
  void Add(const AxisErrors& more, double share);
  // Adds what each kelvin does (ageing.h); gains by `seed`.
  void Warm(const ErrorPopulation& by_kelvin, std::uint64_t seed, double warmer);

 private:
  int axis_;
  double sense_;
  double smoothness_;
  double low_, high_;  // m, of the carriage in M at the ends of its travel
  double scale_;
  std::vector<GaussianProcess> functions_;
  Motions offsets_ = Motions::Zero();  // value of the processes at the reference
  Motions slopes_ = Motions::Zero();   // subtracted
  // Coefficients of s, s^2 and s^3, s from 0 to 1 along the travel.
  Eigen::Matrix<double, kMotions, 3> bends_ = Eigen::Matrix<double, kMotions, 3>::Zero();
};

struct Squareness {
  double a0z, b0z, c0y;  // rad

  static Squareness Draw(const RigSettings& settings, std::uint64_t seed);
  // The direction of motion of an axis in the machine: unit vector.
  Eigen::Vector3d LineOf(int axis) const;
};

// The displacement of what a carriage carries, relative to what carries the carriage: line, error
// motion and turn act at the reference point, which travels with the carriage.
Displacement CarriageDisplacement(const Eigen::Vector3d& line, const Eigen::Vector3d& reference,
                                  double position, const Motions& errors);

}  // namespace abbe::rig
