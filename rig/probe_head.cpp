#include "rig/probe_head.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random/counter_random.h"
#include "rig/streams.h"

namespace abbe::rig {
namespace {

constexpr std::uint64_t kDrawsOfMounting = 64;  // indices of one mounting in its streams

std::uint64_t FaceStream(int side) { return kFaceStream + static_cast<std::uint64_t>(side); }

Eigen::Vector3d NormalVector(const random::CounterRandom& random, std::uint64_t first) {
  return {random.Normal(first), random.Normal(first + 1), random.Normal(first + 2)};
}

Characteristic DrawCharacteristic(const RigSettings& settings, std::uint64_t probe,
                                  std::uint64_t seed) {
  constexpr double kFewest = 0.5, kMost = 3.5;
  const random::CounterRandom random(seed, kLinearityStream);
  Characteristic drawn{settings.linearity * std::sqrt(2.0 / Characteristic::kWaves)};
  for (int wave = 0; wave < Characteristic::kWaves; ++wave) {
    const std::uint64_t index = 8 * probe + 2 * static_cast<std::uint64_t>(wave);
    drawn.periods[wave] = random.Uniform(index, kFewest, kMost);
    drawn.phases[wave] = random.Uniform(index + 1, 0.0, 2.0 * std::numbers::pi);
  }
  return drawn;
}

}  // namespace

double Characteristic::At(double gap) const {
  double sum = 0.0;
  for (int wave = 0; wave < kWaves; ++wave) {
    sum += amplitude * std::sin(2.0 * std::numbers::pi * periods[wave] * gap + phases[wave]);
  }
  return sum;
}

TargetFace::TargetFace(const RigSettings& settings, int side, const Eigen::Vector3d& normal,
                       const Eigen::Vector3d& corner, double reach, std::uint64_t seed)
    : side_(side),
      normal_axis_(side / 2),
      normal_(normal),
      corner_(corner),
      form_(random::CounterRandom(seed, FaceStream(side)), settings.form, settings.form_length,
            -reach, reach) {}

void TargetFace::AddForm(const RigSettings& settings, double sd, double reach, std::uint64_t seed) {
  const auto stream = kHiddenFormStream + static_cast<std::uint64_t>(side_);
  more_form_.emplace_back(random::CounterRandom(seed, stream), sd, settings.form_length, -reach,
                          reach);
}

double TargetFace::GapFrom(const Eigen::Vector3d& point, const Eigen::Vector3d& direction) const {
  const double cosine = -direction.dot(normal_);
  const double to_plane = (point - corner_).dot(normal_) / cosine;
  Eigen::Vector3d hit = point + to_plane * direction - corner_;
  if (reversed_about_) hit = 2.0 * *reversed_about_ - hit;
  // The form is a function of the two coordinates in the face.
  const double first = hit[(normal_axis_ + 1) % 3], second = hit[(normal_axis_ + 2) % 3];
  double form = form_(first, second);
  for (const GaussianSurface& more : more_form_) form += more(first, second);
  return to_plane - form / cosine;
}

std::array<ProbeTruth, kProbes> DrawProbes(const RigSettings& settings, std::uint64_t seed) {
  const random::CounterRandom random(seed, kProbeStream);
  std::array<ProbeTruth, kProbes> probes{};
  for (std::uint64_t probe = 0; probe < kProbes; ++probe) {
    const Eigen::Vector3d place = settings.probe_position * NormalVector(random, 4 * probe);
    const ProbePlace& nominal = settings.probes[probe];
    probes[probe] = {nominal.along + place[0], nominal.across + place[1], place[2],
                     settings.gain * random.Normal(4 * probe + 3),
                     DrawCharacteristic(settings, probe, seed)};
  }
  return probes;
}

HeadInstallation DrawInstallation(const RigSettings& settings, int axis, std::uint64_t seed,
                                  std::uint64_t number) {
  const random::CounterRandom random(seed, kInstallationStream);
  const std::uint64_t first = kDrawsOfMounting * number + 8 * static_cast<std::uint64_t>(axis);
  HeadInstallation installation{settings.installation_angle * NormalVector(random, first),
                                settings.installation_offset * NormalVector(random, first + 3),
                                {}};
  for (const bool top : {true, false}) {
    double middle = 0.0, count = 0.0;
    for (const ProbePlace& probe : settings.probes) {
      if (probe.top != top) continue;
      middle += 0.5 * probe.range;
      count += 1.0;
    }
    installation.set_gap[top ? 0 : 1] =
        middle / std::max(1.0, count) + settings.gap_setting * random.Normal(first + (top ? 6 : 7));
  }
  return installation;
}

std::array<Electrode, kProbes> PlaceElectrodes(const RigSettings& settings, const HeadPlace& place,
                                               const std::array<ProbeTruth, kProbes>& probes,
                                               const HeadInstallation& installation) {
  const Eigen::Matrix3d turn = FullRotation(installation.angles);
  std::array<Electrode, kProbes> electrodes;
  for (int probe = 0; probe < kProbes; ++probe) {
    const bool top = settings.probes[probe].top;
    const auto& [along, across, depth, gain, departs] = probes[probe];
    const double away = installation.set_gap[top ? 0 : 1] + depth;
    const Eigen::Vector3d in_head(along, top ? across : away, top ? away : across);
    electrodes[probe] = {place.position + place.rotation * (turn * in_head + installation.offsets),
                         -(place.rotation * turn).col(top ? 2 : 1)};
  }
  return electrodes;
}

TargetMounting TargetMounting::Draw(const RigSettings& settings, std::uint64_t seed,
                                    std::uint64_t number) {
  const random::CounterRandom random(seed, kTargetStream);
  TargetMounting mounting;
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t index = i;
    mounting.tilt[i] = random.Uniform(kDrawsOfMounting * number + index, -settings.target_tilt,
                                      settings.target_tilt);
    mounting.squareness[i] =
        settings.target_squareness + settings.u_target_squareness * random.Normal(index + 3);
  }
  return mounting;
}

Eigen::Vector3d TargetMounting::NormalOf(const Eigen::Vector3d& nominal) const {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (nominal.x() != 0.0) turn = FullRotation(0.0, squareness.y(), squareness.z());
  if (nominal.y() != 0.0) turn = FullRotation(squareness.x(), 0.0, 0.0);
  return FullRotation(tilt) * turn * nominal;
}

double TiltResponse(double gap, double tilt, double electrode) {
  const double share = electrode * tilt / gap;
  return gap * 0.5 * (1.0 + std::sqrt(std::max(0.0, 1.0 - share * share)));
}

}  // namespace abbe::rig
