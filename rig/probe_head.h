// The true five-probe head and target: the places of the electrodes, the installation of the head
// for the sweep of an axis, the mounting of the target and the form of its faces.
//
// Drawn by the seed, once:  each electrode's place in the fixture (three coordinates), each probe's
// gain and characteristic, the target's tilt, the squareness of its faces, their form. For each axis: the installation
// of the head (three angles, three offsets) and the gap to which the fitter set each unit.
//
// The target is one corner with faces +-x, +-y, +-z (those that the head looks at), mounted once:
// a face keeps its tilt and its form through the sweeps of all axes. The fitter sets the mean gap
// of the top unit and of the side unit to the middle of the range, within `gap_setting`, at the
// start of each sweep. Faces are planes without end; the form of a face adds to them along its
// normal.
//
// Lengths in m, angles in rad; directions and points in the machine frame with all axes at zero.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "rig/gaussian_field.h"
#include "rig/rig_settings.h"
#include "rig/rotation.h"

namespace abbe::rig {

using Readings = std::array<double, kProbes>;

struct Electrode {
  Eigen::Vector3d place;      // of its centre, moves with the head
  Eigen::Vector3d direction;  // towards the face
};

class TargetFace {
 public:
  // `side`: 0 to 5 for -x +x -y +y -z +z; `normal` outward, as mounted; `reach`: half of the
  // extent over which the form is kept.
  TargetFace(const RigSettings& settings, int side, const Eigen::Vector3d& normal,
             const Eigen::Vector3d& corner, double reach, std::uint64_t seed);

  // Adds form of the same correlation length, with this standard deviation.
  void AddForm(const RigSettings& settings, double sd, double reach, std::uint64_t seed);
  // The face turned by half a turn about its normal through corner + middle.
  void Reverse(const Eigen::Vector3d& middle) { reversed_about_ = middle; }

  // The distance from a point to the face along a direction; both seen from the target.
  double GapFrom(const Eigen::Vector3d& point, const Eigen::Vector3d& direction) const;
  const Eigen::Vector3d& normal() const { return normal_; }

 private:
  int side_;
  int normal_axis_;
  Eigen::Vector3d normal_;
  Eigen::Vector3d corner_;
  GaussianSurface form_;
  std::vector<GaussianSurface> more_form_;
  std::optional<Eigen::Vector3d> reversed_about_;
};

// The drawn installation of the head for the sweep of one axis.
struct HeadInstallation {
  Eigen::Vector3d angles;         // about u, s, n
  Eigen::Vector3d offsets;        // along u, s, n; the last two as the gap setting left them
  std::array<double, 2> set_gap;  // mean gap of the top and of the side unit at the start
};

// What a probe departs from its straight characteristic: waves over its range.
struct Characteristic {
  static constexpr int kWaves = 3;
  double amplitude = 0.0;                   // m, of each wave
  std::array<double, kWaves> periods = {};  // over the range
  std::array<double, kWaves> phases = {};   // rad

  // `gap` as a share of the range.
  double At(double gap) const;
};

struct ProbeTruth {
  double along, across, depth;  // true place in the head: u, then s or n; depth > 0: farther away
  double gain;                  // relative error of the sensitivity, about the middle of the range
  Characteristic departs;
};

std::array<ProbeTruth, kProbes> DrawProbes(const RigSettings& settings, std::uint64_t seed);
// `number`: of the mounting.
HeadInstallation DrawInstallation(const RigSettings& settings, int axis, std::uint64_t seed,
                                  std::uint64_t number = 0);

// The electrodes of an installed head; without other errors the mean gap of each unit is `set_gap`.
std::array<Electrode, kProbes> PlaceElectrodes(const RigSettings& settings, const HeadPlace& place,
                                               const std::array<ProbeTruth, kProbes>& probes,
                                               const HeadInstallation& installation);

// The target's orientation: [tilt about x, y, z, squareness A, B, C of its faces].
struct TargetMounting {
  Eigen::Vector3d tilt;
  Eigen::Vector3d squareness;  // YZ: face y turned about x; XZ, XY: face x turned about y, z

  // Another `number` is another tilt of the same target.
  static TargetMounting Draw(const RigSettings& settings, std::uint64_t seed,
                             std::uint64_t number = 0);
  // The outward normal of the face whose nominal normal is an axis direction of the machine.
  Eigen::Vector3d NormalOf(const Eigen::Vector3d& nominal) const;
};

// The gap that a circular electrode of this radius shows at a true gap and a tilt of the face.
double TiltResponse(double gap, double tilt, double electrode);

}  // namespace abbe::rig
