// What a reading of the virtual rig depends on, to first order: kinematics of the machine, the head
// and its target written out once more and differentiated by steps. For rig_map_bound.h; no code of
// simulation/, fusion/ and machine/, and none of the rig but its settings. Units: m, rad.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "rig/rig_settings.h"

namespace abbe::study {

class RigSlopes {
 public:
  using MatrixXd = Eigen::MatrixXd;
  using VectorXd = Eigen::VectorXd;
  using Vector3d = Eigen::Vector3d;
  using Index = Eigen::Index;
  using MotionTable = Eigen::Matrix<double, 3, 6>;  // of X, Y, Z: three shifts, three turns

  // Shared by all: squareness, then of the head and the target.
  enum Shared {
    kSquare = 0,
    kAlong = 3,
    kAcross = 8,
    kDepth = 13,
    kGain = 18,
    kTurn = 23,
    kPlace = 32,
    kSet = 41,
    kTilt = 47,
    kFaces = 50,
    kSharedCount = 53
  };

  // One reading, without noise.
  struct Slopes {
    MotionTable motions = MotionTable::Zero();
    VectorXd shared = VectorXd::Zero(Index{kSharedCount});  // in units of their deviations
    int face = -1;                                          // of a probe: 0 to 5, and where on it
    Eigen::Vector2d hit = Eigen::Vector2d::Zero();
  };

  explicit RigSlopes(const rig::RigSettings& machine) : machine_(machine) {}

  // Where the ball of a perfect machine stands in the workpiece.
  Vector3d BallAt(const Vector3d& position) const {
    return Tool(position, MotionTable::Zero(), Vector3d::Zero());
  }

  // Where it stands, by x, y and z.
  std::array<Slopes, 3> OfBall(const Vector3d& position) const {
    const MatrixXd J = BySteps(VectorXd::Constant(21, 1e-6), [&](const VectorXd& x) -> VectorXd {
      return Tool(position, Unpack(x), x.tail<3>());
    });
    std::array<Slopes, 3> slopes;
    for (Index i = 0; i < 3; ++i) {
      Slopes& each = slopes[static_cast<std::size_t>(i)];
      each.motions = Unpack(J.row(i).head<18>().transpose());
      each.shared.segment<3>(kSquare) =
          machine_.population.squareness * J.row(i).tail<3>().transpose();
    }
    return slopes;
  }

  // What the five probes read in the sweep of an axis.
  std::array<Slopes, 5> OfProbes(int axis, double position) const {
    const Vector3d start = machine_.StartOf(axis);
    Vector3d command = start;
    command[axis] = position;
    const VectorXd sd = SharedDeviations();
    VectorXd steps(6 + Index{kSharedCount});
    steps.head<6>().setConstant(1e-6);
    steps.tail(Index{kSharedCount}) = sd.cwiseMax(1e-9);
    std::array<Slopes, 5> slopes;
    Readings(axis, start, command, VectorXd::Zero(steps.size()), &slopes);
    const MatrixXd J = BySteps(
        steps, [&](const VectorXd& x) -> VectorXd { return Readings(axis, start, command, x); });
    for (Index probe = 0; probe < 5; ++probe) {
      Slopes& each = slopes[static_cast<std::size_t>(probe)];
      each.motions.row(axis) = J.row(probe).head<6>();
      each.shared = sd.cwiseProduct(J.row(probe).tail(Index{kSharedCount}).transpose());
    }
    return slopes;
  }

 private:
  VectorXd SharedDeviations() const {
    VectorXd sd(Index{kSharedCount});
    sd.segment<3>(kSquare).setConstant(machine_.population.squareness);
    sd.segment<15>(kAlong).setConstant(machine_.probe_position);
    sd.segment<5>(kGain).setConstant(machine_.gain);
    sd.segment<9>(kTurn).setConstant(machine_.installation_angle);
    sd.segment<9>(kPlace).setConstant(machine_.installation_offset);
    sd.segment<6>(kSet).setConstant(machine_.gap_setting);
    sd.segment<3>(kTilt).setConstant(machine_.target_tilt / std::sqrt(3.0));
    sd.segment<3>(kFaces).setConstant(machine_.u_target_squareness);
    return sd;
  }

  static Eigen::Matrix3d Turn(const Vector3d& w) {
    const double angle = w.norm();
    if (angle == 0.0) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  }

  // The body at the end of these axes, from the bed; `motions` of the axes at `position`.
  Eigen::Isometry3d Body(const std::string& axes, const Vector3d& position,
                         const MotionTable& motions, const Vector3d& squareness) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (const char letter : axes) {
      const int axis = letter - 'X';
      Vector3d line = Vector3d::Unit(axis);
      if (axis == 1) line = Turn({0, 0, squareness[2]}) * line;
      if (axis == 2) line = Turn({squareness[0], squareness[1], 0}) * line;
      const Vector3d shift = motions.row(axis).head<3>(), turn = motions.row(axis).tail<3>();
      pose = pose * Eigen::Translation3d(machine_.reference + position[axis] * line + shift) *
             Eigen::Quaterniond(Turn(turn)) * Eigen::Translation3d(-machine_.reference);
    }
    return pose;
  }
  Eigen::Isometry3d Work(const Vector3d& position, const MotionTable& motions,
                         const Vector3d& squareness) const {
    const std::string& axes = machine_.workpiece_axes;
    return Body({axes.rbegin(), axes.rend()}, position, motions, squareness);
  }

  // Derivatives of f at zero by central steps of these sizes.
  static MatrixXd BySteps(const VectorXd& steps,
                          const std::function<VectorXd(const VectorXd&)>& f) {
    MatrixXd J(f(VectorXd::Zero(steps.size())).size(), steps.size());
    for (Index i = 0; i < steps.size(); ++i) {
      const VectorXd h = steps[i] * VectorXd::Unit(steps.size(), i);
      J.col(i) = (f(h) - f(-h)) / (2.0 * steps[i]);
    }
    return J;
  }
  static MotionTable Unpack(const VectorXd& x) {
    return Eigen::Map<const Eigen::Matrix<double, 6, 3>>(x.data()).transpose();
  }

  Vector3d Tool(const Vector3d& position, const MotionTable& motions,
                const Vector3d& squareness) const {
    const Vector3d tool = Body(machine_.tool_axes, position, motions, squareness).translation();
    return Work(position, motions, squareness).inverse() * tool;
  }

  // The readings of the five probes; x = [six motions of the swept axis | shared].
  VectorXd Readings(int axis, const Vector3d& start, const Vector3d& command, const VectorXd& x,
                    std::array<Slopes, 5>* seen = nullptr) const {
    const VectorXd s = x.tail(Index{kSharedCount});
    const rig::HeadPlace& head = machine_.head[static_cast<std::size_t>(axis)];
    const Vector3d square = s.segment<3>(kSquare), tilt = s.segment<3>(kTilt),
                   edges = s.segment<3>(kFaces);
    const Vector3d corner = head.position - machine_.TargetTravel(start);
    const Vector3d origin = head.position - machine_.HeadTravel(start);
    const Eigen::Matrix3d turn = head.rotation * Turn(s.segment<3>(kTurn + 3 * axis));
    const auto gaps = [&](const Vector3d& position, const MotionTable& motions) {
      const Eigen::Isometry3d X_WT = Work(position, motions, square).inverse() *
                                     Body(machine_.tool_axes, position, motions, square);
      VectorXd gap(5);
      for (int probe = 0; probe < 5; ++probe) {
        const rig::ProbePlace& place = machine_.probes[static_cast<std::size_t>(probe)];
        const int direction = place.top ? 2 : 1;
        Vector3d in_head(place.along + s[kAlong + probe], 0.0, 0.0);
        in_head[direction] = place.range / 2 + s[kDepth + probe];
        in_head[3 - direction] = place.across + s[kAcross + probe];
        const Vector3d p =
            X_WT * (origin + turn * in_head + head.rotation * s.segment<3>(kPlace + 3 * axis));
        const Vector3d w = -(X_WT.rotation() * turn.col(direction));
        const Vector3d nominal = head.rotation.col(direction);
        Index normal_axis = 0;
        nominal.cwiseAbs().maxCoeff(&normal_axis);
        Eigen::Matrix3d of_face = Eigen::Matrix3d::Identity();
        if (normal_axis == 0) of_face = Turn({0.0, edges[1], edges[2]});
        if (normal_axis == 1) of_face = Turn({edges[0], 0.0, 0.0});
        const Vector3d m = Turn(tilt) * of_face * nominal;
        gap[probe] = (p - corner).dot(m) / -w.dot(m);
        if (seen == nullptr) continue;
        const Vector3d hit = p + gap[probe] * w - corner;
        Slopes& each = (*seen)[static_cast<std::size_t>(probe)];
        each.hit = {hit[(normal_axis + 1) % 3], hit[(normal_axis + 2) % 3]};
        each.face = 2 * static_cast<int>(normal_axis) + (nominal[normal_axis] > 0.0 ? 1 : 0);
      }
      return gap;
    };
    MotionTable motions = MotionTable::Zero();
    const VectorXd before = gaps(start, motions);
    motions.row(axis) = x.head<6>();
    VectorXd gap = gaps(command, motions);
    for (const bool top : {true, false}) {
      double mean = 0.0, count = 0.0;
      for (int probe = 0; probe < 5; ++probe) {
        if (machine_.probes[static_cast<std::size_t>(probe)].top != top) continue;
        mean += before[probe];
        count += 1.0;
      }
      for (int probe = 0; probe < 5; ++probe) {
        const rig::ProbePlace& place = machine_.probes[static_cast<std::size_t>(probe)];
        if (place.top != top) continue;
        // The fitter sets the mean gap of the unit.
        gap[probe] += place.range / 2 + s[kSet + 2 * axis + (top ? 0 : 1)] - mean / count;
        gap[probe] += s[kGain + probe] * (gap[probe] - place.range / 2);
      }
    }
    return gap;
  }

  const rig::RigSettings machine_;
};

}  // namespace abbe::study
