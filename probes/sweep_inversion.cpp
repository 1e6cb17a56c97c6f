#include "probes/sweep_inversion.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace abbe::probes {
namespace {

constexpr std::string_view kRotationLetters = "ABC";

// The angle between the target's surface and the face of the probe: error minus installation angle
// where the target moves, their sum where the head moves.
double TiltUnder(std::size_t probe, MovingBody moving, const HeadErrors<>& errors,
                 const Installation<>& installed) {
  const double sense = moving == MovingBody::kTarget ? -1.0 : 1.0;
  const double roll = errors.eax + sense * installed.roll;
  const double other = probe < kTopProbes ? errors.ebx + sense * installed.pitch
                                          : errors.ecx + sense * installed.yaw;
  return std::hypot(roll, other);
}

// The axis of M along which a column of the rotation points; the columns are axes of M.
int AlongAxis(const Eigen::Vector3d& column) {
  Eigen::Index axis = 0;
  column.cwiseAbs().maxCoeff(&axis);
  return static_cast<int>(axis);
}

std::array<Component, kComponents> ComponentsOf(const AxisFrame& frame, char axis) {
  std::array<Component, kComponents> components;
  constexpr std::array<const char*, 3> kKinds = {"roll", "pitch", "yaw"};
  for (int column = 0; column < 3; ++column) {
    const int about = AlongAxis(frame.R_MH.col(column));
    components[about] = {fmt::format("E{}{}", kRotationLetters[about], axis), kKinds[column]};
  }
  int row = 3;
  for (char direction = 'X'; direction <= 'Z'; ++direction) {
    if (direction == axis) continue;
    components[row++] = {fmt::format("E{}{}", direction, axis), "straightness"};
  }
  return components;
}

}  // namespace

SweepInversion::SweepInversion(const machine::Machine& machine, const HeadSettings& head, char axis,
                               const Eigen::Vector3d& start)
    : head_(head),
      moving_(machine.chain.CarriesTarget(axis) ? MovingBody::kTarget : MovingBody::kHead),
      invert_(InstalledLines(head.layout, head.installation), moving_),
      R_MH_(head.Frame(axis).R_MH),
      sense_(machine.chain.CarriageSense(axis)),
      start_(start[machine::AxisIndex(axis)]) {
  const AxisFrame& frame = head.Frame(axis);
  const int swept = machine::AxisIndex(axis);
  components_ = ComponentsOf(frame, axis);
  across_ = {(swept == 0) ? 1 : 0, (swept == 2) ? 1 : 2};
  lever_ = frame.p_MH - machine.reference;
  for (const char mover : machine.chain.Movers(axis)) {
    const int index = machine::AxisIndex(mover);
    lever_[index] -= machine.chain.CarriageSense(mover) * start[index];
  }
}

GroupReadings SweepInversion::Deltas(const GroupReadings& readings,
                                     const Eigen::VectorXd& positions, Eigen::Index first) const {
  PerProbe<> zero{};
  const auto gap_to_delta = [&](const GroupReadings& gaps) {
    GroupReadings delta = gaps;
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      zero[probe] = head_.probes[probe].zero_gap.value_or(gaps.row(probe).head(first).mean());
      delta.row(probe) = (zero[probe] - gaps.row(probe).array()) / head_.probes[probe].gain;
    }
    return delta;
  };
  GroupReadings delta = gap_to_delta(readings);
  const bool tilts = head_.electrode.radius > 0.0;
  if (!tilts && head_.electrode.stray == 0.0) return delta;
  // The response depends on the tilt, and the tilt on the gaps: the second round is exact to 1e-6
  // of the response.
  for (int round = 0; round < (tilts ? 2 : 1); ++round) {
    GroupReadings gaps = readings;
    for (Eigen::Index group = 0; group < gaps.cols(); ++group) {
      PerProbe<> at;
      for (std::size_t probe = 0; probe < kProbes; ++probe) {
        at[probe] = delta(probe, group);
      }
      const HeadErrors<> errors = invert_(at, Travel(positions[group]));
      for (std::size_t probe = 0; probe < kProbes; ++probe) {
        double& gap = gaps(probe, group);
        gap = ElectrodeGap(head_.electrode, gap,
                           TiltUnder(probe, moving_, errors, head_.installation));
      }
    }
    delta = gap_to_delta(gaps);
  }
  return delta;
}

SweepInversion::ErrorColumn SweepInversion::ErrorsAt(const PerProbe<>& delta, double travel) const {
  const HeadErrors<> errors = invert_(delta, travel);
  const Eigen::Vector3d rotation = R_MH_ * Eigen::Vector3d(errors.eax, errors.ebx, errors.ecx);
  const Eigen::Vector3d at_target = R_MH_ * Eigen::Vector3d(0.0, errors.eyx, errors.ezx);
  const Eigen::Vector3d at_reference = at_target - rotation.cross(lever_);
  ErrorColumn column;
  column << rotation, at_reference[across_[0]], at_reference[across_[1]],  //
      rotation, at_target[across_[0]], at_target[across_[1]];
  return column;
}

GroupErrors SweepInversion::Errors(const GroupReadings& readings, const Eigen::VectorXd& positions,
                                   Eigen::Index first) const {
  const GroupReadings delta = Deltas(readings, positions, first);
  GroupErrors errors(kErrorRows, readings.cols());
  for (Eigen::Index group = 0; group < readings.cols(); ++group) {
    PerProbe<> at;
    Eigen::Map<Eigen::Matrix<double, kProbes, 1>>(at.data()) = delta.col(group);
    errors.col(group) = ErrorsAt(at, Travel(positions[group]));
  }
  return errors;
}

std::vector<GroupJacobian> SweepInversion::Jacobians(const GroupReadings& readings,
                                                     const Eigen::VectorXd& positions,
                                                     Eigen::Index first) const {
  // Second-order terms cancel; the third order of 0.1 um is below the rounding of the inversion.
  constexpr double kStep = 1e-7;
  const GroupReadings delta = Deltas(readings, positions, first);
  std::vector<GroupJacobian> jacobians(readings.cols());
  for (Eigen::Index group = 0; group < readings.cols(); ++group) {
    PerProbe<> at;
    Eigen::Map<Eigen::Matrix<double, kProbes, 1>>(at.data()) = delta.col(group);
    const double travel = Travel(positions[group]);
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      PerProbe<> up = at, down = at;
      up[probe] += kStep;
      down[probe] -= kStep;
      jacobians[group].col(probe) = (ErrorsAt(up, travel) - ErrorsAt(down, travel)) / (2.0 * kStep);
    }
  }
  return jacobians;
}

}  // namespace abbe::probes
