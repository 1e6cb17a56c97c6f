// The five errors of the swept axis in the names of ISO 230-1 from mean gaps, at the target and at
// the axis reference.
//
//   1. reading -> gap: inverse response of the electrode to tilt and stray capacitance
//   2. Delta = (zero_gap - gap) / gain; zero_gap is that of the machine file, else the mean of the
//      first station
//   3. errors in H: exact inversion with full rotations, for the body that the chain moves
//   4. errors in the machine frame M: for Y, roll = EBY, pitch = -EAY, yaw = ECY
//   5. from the target, where a straightness is measured, to the axis reference of the error map:
//
//        t_reference = t_target - w x r,   for X:   EYX = EYX_target - r_x ECX + r_z EAX
//
// w are the three angles. r goes from the reference point of the swept axis's carriage to the
// origin of the head, both at the start of the sweep; the axes that move that carriage have moved
// its reference point. Angles are the same at both places.
//
// Frames: H in the inversion, M in the result.
// Units: m, rad. Shapes: errors 10 x groups, at the reference and then at the target; gaps 5 x
// groups.
// Failure: InputError when the head has no frame for the axis, or where the electrode response has
// no inverse; NumericalError for readings that no small motion gives.
// Source: docs/theory-head.md.
// Validity: that of RigidInversion; tilt and response of the electrode are found in two rounds,
// exact to 1e-6 of the response.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "machine/machine.h"
#include "probes/head_inversion.h"
#include "probes/head_settings.h"
#include "probes/sweep_gauge.h"

namespace abbe::probes {

inline constexpr int kComponents = 5;

// A row of an error matrix. Order for X: EAX EBX ECX EYX EZX; for Z: EAZ EBZ ECZ EXZ EYZ.
struct Component {
  std::string name;
  std::string kind;  // "roll", "pitch", "yaw" or "straightness"
  bool angle() const { return kind != "straightness"; }
  SweepGauge::Kind gauge() const {
    return angle() ? SweepGauge::Kind::kFirstStation : SweepGauge::Kind::kLine;
  }
};

// Rows: the components at the axis reference, then the components at the target. Columns: groups.
inline constexpr int kErrorRows = 2 * kComponents;
using GroupErrors = Eigen::Matrix<double, kErrorRows, Eigen::Dynamic>;
using GroupReadings = Eigen::Matrix<double, kProbes, Eigen::Dynamic>;
using GroupJacobian = Eigen::Matrix<double, kErrorRows, kProbes>;

class SweepInversion {
 public:
  // `start`: m, position [x y z] of all axes at the start of the sweep.
  SweepInversion(const machine::Machine& machine, const HeadSettings& head, char axis,
                 const Eigen::Vector3d& start);

  const std::array<Component, kComponents>& components() const { return components_; }
  MovingBody moving() const { return moving_; }

  // How far the carriage has gone towards +u since the start, m.
  double Travel(double position) const { return sense_ * (position - start_); }
  // +1 where the carriage moves towards +u as the axis position increases, else -1
  // (machine/chain.h).
  double sense() const { return sense_; }

  // Errors per group, before any gauge. The first `first` groups belong to the first station.
  GroupErrors Errors(const GroupReadings& readings, const Eigen::VectorXd& positions,
                     Eigen::Index first) const;
  // The derivatives of Errors with respect to Delta, group by group, by central differences.
  std::vector<GroupJacobian> Jacobians(const GroupReadings& readings,
                                       const Eigen::VectorXd& positions, Eigen::Index first) const;

 private:
  using ErrorColumn = Eigen::Matrix<double, kErrorRows, 1>;

  GroupReadings Deltas(const GroupReadings& readings, const Eigen::VectorXd& positions,
                       Eigen::Index first) const;
  ErrorColumn ErrorsAt(const PerProbe<>& delta, double travel) const;

  HeadSettings head_;
  MovingBody moving_;
  RigidInversion invert_;
  std::array<Component, kComponents> components_;
  std::array<int, 2> across_;  // indices in M of the two straightness directions
  Eigen::Matrix3d R_MH_;
  Eigen::Vector3d lever_;  // m, in M: r above
  double sense_ = 1.0;
  double start_ = 0.0;
};

}  // namespace abbe::probes
