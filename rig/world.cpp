#include "rig/world.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace abbe::rig {
namespace {

// Setting a gap moves the head, which changes the other unit's gap by the tilts: each round is a
// thousand times closer.
constexpr int kSettingRounds = 4;

// Half of the extent over which the form of a face is kept: beyond it the same form costs more
// time.
double FaceReach(const RigSettings& settings, int axis) {
  double arm = 0.0;
  for (const ProbePlace& probe : settings.probes) {
    arm = std::max({arm, std::abs(probe.along), std::abs(probe.across)});
  }
  return settings.travels[axis].last - settings.travels[axis].first + 2.0 * arm;
}

// 0 to 5 for -x +x -y +y -z +z.
int SideOf(const Eigen::Vector3d& nominal_normal) {
  int axis = 0;
  nominal_normal.cwiseAbs().maxCoeff(&axis);
  return 2 * axis + (nominal_normal[axis] > 0.0 ? 1 : 0);
}

}  // namespace

World::World(const RigSettings& settings, std::uint64_t seed)
    : settings_(settings),
      seed_(seed),
      squareness_(Squareness::Draw(settings, seed)),
      probes_(DrawProbes(settings, seed)),
      mounting_(TargetMounting::Draw(settings, seed)) {
  for (int axis = 0; axis < kAxes; ++axis) errors_.emplace_back(settings_, axis, seed);
  for (int axis = 0; axis < kAxes; ++axis) heads_.push_back(Install(axis));
}

World::InstalledHead World::Install(int axis) const {
  const Eigen::Vector3d start = settings_.StartOf(axis);
  HeadPlace place = settings_.head[axis];
  const Eigen::Vector3d corner = place.position - settings_.TargetTravel(start);
  place.position -= settings_.HeadTravel(start);
  InstalledHead head{DrawInstallation(settings_, axis, seed_), {}, {}};
  for (const int direction : {2, 1}) {  // n: the top face, s: the side face
    const Eigen::Vector3d nominal = place.rotation.col(direction);
    head.faces.emplace_back(settings_, SideOf(nominal), mounting_.NormalOf(nominal), corner,
                            FaceReach(settings_, axis), seed_);
  }
  // The fitter watches the gaps while he sets the head.
  for (int round = 0; round < kSettingRounds; ++round) {
    head.electrodes = PlaceElectrodes(settings_, place, probes_, head.installation);
    const auto sights = SightsOf(head, start);
    for (const bool top : {true, false}) {
      double sum = 0.0, count = 0.0;
      for (int probe = 0; probe < kProbes; ++probe) {
        if (settings_.probes[probe].top != top) continue;
        sum += sights[probe].gap;
        count += 1.0;
      }
      if (count == 0.0) continue;
      head.installation.offsets[top ? 2 : 1] +=
          head.installation.set_gap[top ? 0 : 1] - sum / count;
    }
  }
  head.electrodes = PlaceElectrodes(settings_, place, probes_, head.installation);
  return head;
}

Displacement World::PoseOf(const std::string& axes_from_bed, const Eigen::Vector3d& command) const {
  Displacement pose;
  for (const char letter : axes_from_bed) {
    const int axis = letter - 'X';
    pose = pose * CarriageDisplacement(squareness_.LineOf(axis), settings_.reference, command[axis],
                                       errors_[axis].At(command[axis]));
  }
  return pose;
}

Displacement World::PoseOfTarget(const Eigen::Vector3d& command) const {
  return PoseOf({settings_.workpiece_axes.rbegin(), settings_.workpiece_axes.rend()}, command);
}

Displacement World::PoseOfHead(const Eigen::Vector3d& command) const {
  return PoseOf(settings_.tool_axes, command);
}

std::array<World::Sight, kProbes> World::SightsOf(const InstalledHead& head,
                                                  const Eigen::Vector3d& command) const {
  const Displacement target = PoseOfTarget(command);
  const Displacement tool = PoseOfHead(command);
  // The head as the target sees it.
  const Eigen::Matrix3d back = target.rotation.transpose();
  std::array<Sight, kProbes> sights{};
  for (int probe = 0; probe < kProbes; ++probe) {
    const Electrode& electrode = head.electrodes[probe];
    const Eigen::Vector3d place = back * (tool * electrode.place - target.translation);
    const Eigen::Vector3d direction = back * (tool.rotation * electrode.direction);
    const TargetFace& face = head.FaceOf(settings_.probes[probe]);
    sights[probe] = {face.GapFrom(place, direction), direction.cross(face.normal()).norm()};
  }
  return sights;
}

double World::ResponseTo(const Sight& sight, int probe) const {
  const double middle = 0.5 * settings_.probes[probe].range;
  double gap = sight.gap;
  if (settings_.electrode > 0.0 && gap > 0.0) {
    gap = TiltResponse(gap, sight.tilt, settings_.electrode);
  }
  return middle + (1.0 + probes_[probe].gain) * (gap - middle);
}

Readings World::TrueGaps(int axis, const Eigen::Vector3d& command) const {
  const auto sights = SightsOf(heads_[axis], command);
  Readings gaps{};
  for (int probe = 0; probe < kProbes; ++probe) gaps[probe] = sights[probe].gap;
  return gaps;
}

Readings World::ReadingsAt(int axis, const Eigen::Vector3d& command) const {
  const auto sights = SightsOf(heads_[axis], command);
  Readings readings{};
  for (int probe = 0; probe < kProbes; ++probe) readings[probe] = ResponseTo(sights[probe], probe);
  return readings;
}

}  // namespace abbe::rig
