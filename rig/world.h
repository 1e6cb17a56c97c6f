// The world of the virtual rig: one machine with its head and target, drawn by a seed from the
// population of the machine file, with the readings of the five probes at any commanded position.
//
// Nothing here is linearised: full rotations, the product of the carriages' displacements in the
// order of the chain, and the intersection of each probe's axis with the target's real face. It
// shares no code with the models that are tested against it.
//
// The stages of a reading:
//   machine motion    PoseOfTarget, PoseOfHead: displacements by the carriages at a command
//   probe geometry    SightsOf: electrode to face along the probe's axis
//   probe response    ResponseTo: tilt response, gain about the middle of the range; then
//                     ResponseOf: hidden nonlinearity, crosstalk and inverted signs
//   noise             noise.h, a function of time
// motion.h has the motion in time, register_server.h the numbers on the wire.
// Hidden effects that are constants of machine, head or target are built in here; those that depend
// on time, motion or temperature come from hidden_run.h, as changed commands and readings.
//
// Frames: M, the machine. The coordinates of a point that moves with the target (the head) are
// those in M with all axes at zero and without error; the pose takes it to its present place.
// Command: [x y z] in m. Each error motion acts at the machine's reference point, which travels
// with its carriage: this includes the effect of Abbe offsets.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rig/axis_errors.h"
#include "rig/hidden_effect.h"
#include "rig/probe_head.h"
#include "rig/rig_settings.h"
#include "rig/rotation.h"
#include "rig/world_parts.h"

namespace abbe::rig {

// How head and target are mounted for the sweeps.
struct Mounting {
  std::uint64_t number = 0;      // each draws the target's tilt and the head's installation anew
  double target_shift = 0.0;     // m, of the target along u
  bool target_reversed = false;  // each face turned by half a turn about its normal, so that its
                                 // first part is measured last
  bool head_turned = false;      // by half a turn about n: the side unit faces the other side
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
  const Squareness& squareness() const { return parts_.squareness; }
  const std::array<ProbeTruth, kProbes>& probes() const { return parts_.probes; }
  const TargetMounting& target() const { return mounting_; }
  const HeadInstallation& InstallationOf(int axis) const { return heads_[axis].installation; }

  // Over days (ageing.h): adds the errors of another machine of `population`, drawn by `seed`; and
  // what it does when it is warmer.
  void Wander(const RigSettings& population, std::uint64_t seed, double share);
  void Warm(const ErrorPopulation& by_kelvin, double warmer);

  Displacement PoseOfTarget(const Eigen::Vector3d& command) const;
  Displacement PoseOfHead(const Eigen::Vector3d& command) const;

  // The corner of the target, with all axes at zero, as it stands for the sweep of `axis`.
  Eigen::Vector3d CornerOf(int axis) const;

  // With the head installed for the sweep of `axis`, and the target displaced by `seat` since
  // (target_screws.h). m; without noise.
  Readings TrueGaps(int axis, const Eigen::Vector3d& command, const Displacement& seat = {}) const;
  Readings ReadingsAt(int axis, const Eigen::Vector3d& command,
                      const Displacement& seat = {}) const;

 private:
  // The head as installed for the sweep of one axis, and its two faces of the target.
  struct InstalledHead {
    HeadInstallation installation;
    std::array<Electrode, kProbes> electrodes;
    std::vector<TargetFace> faces;  // top, side
    Readings at_start{};            // zero of the hidden response of the probes

    const TargetFace& FaceOf(const ProbePlace& probe) const { return faces[probe.top ? 0 : 1]; }
  };

  InstalledHead Install(int axis) const;
  // The target and the head before the fitter sets the gaps.
  InstalledHead Mount(int axis, HeadPlace& place) const;
  Readings ResponseOf(const InstalledHead& head, const Readings& readings) const;
  Displacement PoseOf(const std::string& axes_from_bed, const Eigen::Vector3d& command) const;
  // The face in front of a probe.
  struct Sight {
    double gap;   // m, along the probe's axis
    double tilt;  // rad, between the probe's axis and the face's normal
  };

  std::array<Sight, kProbes> SightsOf(const InstalledHead& head, const Eigen::Vector3d& command,
                                      const Displacement& seat = {}) const;
  double ResponseTo(const Sight& sight, int probe) const;

  RigSettings settings_;
  std::uint64_t seed_;
  HiddenEffects hidden_;
  Mounting head_and_target_;
  std::vector<AxisErrors> errors_;
  WorldParts parts_;
  TargetMounting mounting_;
  std::vector<InstalledHead> heads_;
};

}  // namespace abbe::rig
