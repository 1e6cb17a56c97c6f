#include "rig/world.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "random/counter_random.h"
#include "rig/streams.h"

namespace abbe::rig {
namespace {

// Setting a gap moves the head, which changes the other unit's gap by the tilts: each round is a
// thousand times closer.
constexpr int kSettingRounds = 4;

// Half of the extent over which the form of a face is stored: beyond it the same form takes longer
// to compute.
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

World::World(const RigSettings& settings, std::uint64_t seed, HiddenEffects hidden,
             const Mounting& mounting)
    : settings_(settings),
      seed_(seed),
      hidden_(std::move(hidden)),
      head_and_target_(mounting),
      parts_{Squareness::Draw(settings, seed), DrawProbes(settings, seed), settings.electrode},
      mounting_(TargetMounting::Draw(settings, seed, mounting.number)) {
  for (const HiddenEffect& effect : hidden_) {
    if (effect.entry->in_world != nullptr) effect.entry->in_world(effect, parts_);
  }
  settings_.electrode = parts_.electrode;
  for (int axis = 0; axis < kAxes; ++axis) errors_.emplace_back(settings_, axis, seed);
  for (int axis = 0; axis < kAxes; ++axis) heads_.push_back(Install(axis));
}

void World::Wander(const RigSettings& population, std::uint64_t seed, double share) {
  for (int axis = 0; axis < kAxes; ++axis) {
    errors_[axis].Add(AxisErrors(population, axis, seed), share);
  }
  const Squareness more = Squareness::Draw(population, seed);
  parts_.squareness.a0z += share * more.a0z;
  parts_.squareness.b0z += share * more.b0z;
  parts_.squareness.c0y += share * more.c0y;
}

void World::Warm(const ErrorPopulation& by_kelvin, double warmer) {
  for (int axis = 0; axis < kAxes; ++axis) errors_[axis].Warm(by_kelvin, seed_, warmer);
  const random::CounterRandom random(seed_, kResponseStream);
  const double size = by_kelvin.squareness * warmer;
  parts_.squareness.a0z += size * random.Normal(36);
  parts_.squareness.b0z += size * random.Normal(37);
  parts_.squareness.c0y += size * random.Normal(38);
}

Eigen::Vector3d World::CornerOf(int axis) const {
  const HeadPlace& place = settings_.head[axis];
  return place.position - settings_.TargetTravel(settings_.StartOf(axis)) +
         head_and_target_.target_shift * place.rotation.col(0);
}

World::InstalledHead World::Mount(int axis, HeadPlace& place) const {
  const Eigen::Vector3d start = settings_.StartOf(axis);
  place = settings_.head[axis];
  const Eigen::Vector3d along = place.rotation.col(0);
  const Eigen::Vector3d corner = CornerOf(axis);
  place.position -= settings_.HeadTravel(start);
  if (head_and_target_.head_turned) place.rotation.leftCols<2>() *= -1.0;
  InstalledHead head{DrawInstallation(settings_, axis, seed_, head_and_target_.number), {}, {}};
  head.installation.angles += parts_.head_angles;
  head.installation.offsets += parts_.head_offsets;
  for (const int direction : {2, 1}) {  // n: the top face, s: the side face
    const Eigen::Vector3d nominal = place.rotation.col(direction);
    TargetFace face(settings_, SideOf(nominal), mounting_.NormalOf(nominal), corner,
                    FaceReach(settings_, axis), seed_);
    for (const double rms : parts_.forms[2 - direction]) {
      face.AddForm(settings_, rms, FaceReach(settings_, axis), seed_);
    }
    if (head_and_target_.target_reversed) {
      // About the middle of the stretch that the head passes.
      const double length = settings_.sweeps[axis]
                                ? settings_.sweeps[axis]->last() - settings_.sweeps[axis]->first()
                                : settings_.travels[axis].last - settings_.travels[axis].first;
      face.Reverse(0.5 * settings_.ToolWay(axis) * length * along);
    }
    head.faces.push_back(std::move(face));
  }
  return head;
}

World::InstalledHead World::Install(int axis) const {
  const Eigen::Vector3d start = settings_.StartOf(axis);
  HeadPlace place;
  InstalledHead head = Mount(axis, place);
  // The fitter watches the gaps while he sets the head.
  for (int round = 0; round < kSettingRounds; ++round) {
    head.electrodes = PlaceElectrodes(settings_, place, parts_.probes, head.installation);
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
  head.electrodes = PlaceElectrodes(settings_, place, parts_.probes, head.installation);
  if (parts_.response.any) {
    const auto sights = SightsOf(head, start);
    for (int probe = 0; probe < kProbes; ++probe) {
      head.at_start[probe] = ResponseTo(sights[probe], probe);
    }
  }
  return head;
}

Displacement World::PoseOf(const std::string& axes_from_bed, const Eigen::Vector3d& command) const {
  Displacement pose;
  for (const char letter : axes_from_bed) {
    const int axis = letter - 'X';
    const double sense = settings_.sense[axis];
    Motions errors = errors_[axis].At(command[axis]);
    errors[axis] *= sense;
    pose = pose * CarriageDisplacement(parts_.squareness.LineOf(axis), settings_.reference,
                                       sense * command[axis], errors);
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
                                                  const Eigen::Vector3d& command,
                                                  const Displacement& seat) const {
  const Displacement target = PoseOfTarget(command) * seat;
  const Displacement tool = PoseOfHead(command);
  // The head in the frame of the target.
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
  return middle + (1.0 + parts_.probes[probe].gain) * (gap - middle) +
         parts_.probes[probe].departs.At(gap / settings_.probes[probe].range);
}

Readings World::TrueGaps(int axis, const Eigen::Vector3d& command, const Displacement& seat) const {
  const auto sights = SightsOf(heads_[axis], command, seat);
  Readings gaps{};
  for (int probe = 0; probe < kProbes; ++probe) gaps[probe] = sights[probe].gap;
  return gaps;
}

Readings World::ReadingsAt(int axis, const Eigen::Vector3d& command,
                           const Displacement& seat) const {
  const auto sights = SightsOf(heads_[axis], command, seat);
  Readings readings{};
  for (int probe = 0; probe < kProbes; ++probe) readings[probe] = ResponseTo(sights[probe], probe);
  return parts_.response.any ? ResponseOf(heads_[axis], readings) : readings;
}

Readings World::ResponseOf(const InstalledHead& head, const Readings& readings) const {
  Readings change{}, shown{};  // d, true and as read
  for (std::size_t i = 0; i < kProbes; ++i) change[i] = head.at_start[i] - readings[i];
  for (std::size_t i = 0; i < kProbes; ++i) {
    double said = change[i] + parts_.response.quadratic[i] * change[i] * change[i];
    for (std::size_t k = 0; k < kProbes; ++k) said += parts_.response.of[i][k] * change[k];
    shown[i] = head.at_start[i] - (parts_.response.inverted[i] ? -said : said);
  }
  return shown;
}

}  // namespace abbe::rig
