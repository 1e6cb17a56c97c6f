// The world of the virtual rig: one machine with its head and target, drawn by a seed from the
// population of the machine file, that answers what the five probes read at any commanded position.
//
// Nothing here is linearised: full rotations, the product of the carriages' displacements in the
// order of the chain, and the intersection of each probe's axis with the target's real face. It
// shares no code with the models that are tested against it.
//
// How a reading comes about, stage by stage:
//   machine motion    PoseOfTarget, PoseOfHead: what the carriages do at a command
//   probe geometry    SightsOf: electrode to face along the probe's axis
//   probe response    ResponseTo: tilt response, gain about the middle of the range; then, where it
//                     is hidden, what is no gain of one probe alone (ResponseOf)
//   noise             noise.h, a function of the time
// The motion in time is motion.h; what becomes of the numbers on the wire is register_server.h.
// Hidden effects that are constants of machine, head or target are built in here; those that depend
// on time, motion or temperature come from hidden_run.h, as another command and other readings.
//
// Frames: M, the machine. A point that moves with the target (the head) is named by where it stands
// in M when all axes are at zero and without error; the pose takes it to where it stands now.
// Command: [x y z] in m. Each error motion acts at the machine's reference point, which travels
// with its carriage, so Abbe arms arise by themselves.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rig/axis_errors.h"
#include "rig/hidden_effect.h"
#include "rig/probe_head.h"
#include "rig/rig_settings.h"
#include "rig/rotation.h"

namespace abbe::rig {

// How head and target are mounted for the sweeps.
struct Mounting {
  std::uint64_t number = 0;      // each draws the target's tilt and the head's installation anew
  double target_shift = 0.0;     // m, of the target along u
  bool target_reversed = false;  // each face turned by half a turn about its normal, so that what
                                 // was seen first is seen last
  bool head_turned = false;      // by half a turn about n: the side unit looks at the other side
};

class World {
 public:
  World(const RigSettings& settings, std::uint64_t seed, HiddenEffects hidden = {},
        const Mounting& mounting = {});

  const RigSettings& settings() const { return settings_; }
  std::uint64_t seed() const { return seed_; }
  const HiddenEffects& hidden() const { return hidden_; }

  Motions ErrorsOf(int axis, double position) const { return errors_[axis].At(position); }
  double ScaleOf(int axis) const { return errors_[axis].scale(); }
  const Squareness& squareness() const { return squareness_; }
  const std::array<ProbeTruth, kProbes>& probes() const { return probes_; }
  const TargetMounting& target() const { return mounting_; }
  const HeadInstallation& InstallationOf(int axis) const { return heads_[axis].installation; }

  Displacement PoseOfTarget(const Eigen::Vector3d& command) const;
  Displacement PoseOfHead(const Eigen::Vector3d& command) const;

  // With the head installed for the sweep of `axis`. m; without noise.
  Readings TrueGaps(int axis, const Eigen::Vector3d& command) const;
  Readings ReadingsAt(int axis, const Eigen::Vector3d& command) const;

 private:
  // The head as it was installed for the sweep of one axis, and the two faces that it looks at.
  struct InstalledHead {
    HeadInstallation installation;
    std::array<Electrode, kProbes> electrodes;
    std::vector<TargetFace> faces;  // top, side
    Readings at_start{};            // where the hidden response of the probes has its zero

    const TargetFace& FaceOf(const ProbePlace& probe) const { return faces[probe.top ? 0 : 1]; }
  };

  // What is hidden in the response of the probes, in d = gap at the start - gap.
  struct Response {
    Readings quadratic{};                                   // 1/m
    std::array<std::array<double, kProbes>, kProbes> of{};  // of[i][k]: of d of k in the reading i
    std::array<bool, kProbes> inverted{};
    bool any = false;
  };

  void Build(const HiddenEffect& effect);
  InstalledHead Install(int axis) const;
  // The target and the head before the fitter sets the gaps.
  InstalledHead Mount(int axis, HeadPlace& place) const;
  Readings ResponseOf(const InstalledHead& head, const Readings& readings) const;
  Displacement PoseOf(const std::string& axes_from_bed, const Eigen::Vector3d& command) const;
  // What lies before each probe.
  struct Sight {
    double gap;   // m, along the probe's axis
    double tilt;  // rad, between the probe's axis and the face's normal
  };

  std::array<Sight, kProbes> SightsOf(const InstalledHead& head,
                                      const Eigen::Vector3d& command) const;
  double ResponseTo(const Sight& sight, int probe) const;

  RigSettings settings_;
  std::uint64_t seed_;
  HiddenEffects hidden_;
  Mounting set_up_;
  std::vector<AxisErrors> errors_;
  Squareness squareness_;
  std::array<ProbeTruth, kProbes> probes_;
  TargetMounting mounting_;
  Response response_;
  Eigen::Vector3d hidden_angles_ = Eigen::Vector3d::Zero();   // of the head's installation
  Eigen::Vector3d hidden_offsets_ = Eigen::Vector3d::Zero();  // likewise
  std::vector<InstalledHead> heads_;
};

}  // namespace abbe::rig
