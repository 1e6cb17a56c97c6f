// A linkage of three pivots with errors, written out as one product of rotations, and what its
// encoders say while a perfect machine [w X Y b Z t] carries the ball about: an oracle that shares
// no code with relm/ and simulation/. SI units.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <string_view>
#include <vector>

#include "machine/chain.h"
#include "random/counter_random.h"
#include "relm/linkage_settings.h"
#include "settings/document.h"
#include "simulation/linkage/linkage_run.h"

namespace abbe::fusion {

inline constexpr std::string_view kWorldText = R"(
[linkage]
form = "pivots"
link_1_mm = 130
link_2_mm = 110
[linkage.base]
position_mm = [-180, -30, -30]
)";

inline relm::LinkageSettings WorldSettings(std::string_view text = kWorldText) {
  return relm::ReadLinkageSettings(settings::Document::Parse(text, "world.toml").Root());
}
inline machine::Chain WorldChain() { return machine::Chain::Parse("[w X Y b Z t]"); }

struct LinkageWorld {
  double link_1 = 0.130, link_2 = 0.110;
  Eigen::Vector2d tilt = {0, 0};
  double twist_pivot_2 = 0, twist_link_1 = 0;
  Eigen::Vector2d divergence = {0, 0};
  Eigen::Vector3d offset = {0, 0, 0};
  Eigen::Vector3d eccentricity_sin = {0, 0, 0}, eccentricity_cos = {0, 0, 0};
  Eigen::Vector3d base = {-0.180, -0.030, -0.030};
  Eigen::Vector3d base_turn = {0, 0, 0};

  static LinkageWorld Draw(std::uint64_t seed, bool with_encoder_errors) {
    const random::CounterRandom random(seed, 77);
    std::uint64_t at = 0;
    const auto normal = [&](double sd) { return sd * random.Normal(at++); };
    LinkageWorld world;
    world.link_1 += normal(100e-6);
    world.link_2 += normal(100e-6);
    world.tilt = {normal(500e-6), normal(500e-6)};
    world.twist_pivot_2 = normal(500e-6);
    world.twist_link_1 = normal(500e-6);
    world.divergence = {normal(20e-6), normal(20e-6)};
    for (int i = 0; i < 3; ++i) {
      world.offset[i] = normal(1000e-6);
      world.eccentricity_sin[i] = normal(with_encoder_errors ? 20e-6 : 0.0);
      world.eccentricity_cos[i] = normal(with_encoder_errors ? 20e-6 : 0.0);
      world.base[i] += normal(500e-6);
      world.base_turn[i] = normal(2000e-6);
    }
    return world;
  }

  // The ball in M for what the encoders say.
  Eigen::Vector3d Ball(const Eigen::Vector3d& q) const {
    using Eigen::AngleAxisd, Eigen::Translation3d, Eigen::Vector3d;
    const auto x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    const Vector3d angle =
        q + offset +
        (eccentricity_sin.array() * q.array().sin() + eccentricity_cos.array() * q.array().cos())
            .matrix();
    const Eigen::Isometry3d arm =
        AngleAxisd(tilt[0], x) * AngleAxisd(tilt[1], y) * AngleAxisd(angle[0], z) *
        AngleAxisd(twist_pivot_2, x) * Translation3d(divergence[0], divergence[1], 0) *
        AngleAxisd(angle[1], y) * Translation3d(link_1, 0, 0) * AngleAxisd(twist_link_1, x) *
        AngleAxisd(angle[2], y) * Translation3d(0, 0, link_2);
    const double turn = base_turn.norm();
    const AngleAxisd R(turn, turn > 0 ? Vector3d(base_turn / turn) : Vector3d(x));
    return base + R * arm.translation();
  }

  // What the encoders say with the ball at p_MT: Newton steps from `near`.
  Eigen::Vector3d Readings(const Eigen::Vector3d& p_MT, Eigen::Vector3d near) const {
    for (int step = 0; step < 12; ++step) {
      Eigen::Matrix3d J;
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d h = 1e-5 * Eigen::Vector3d::Unit(i);
        J.col(i) = (Ball(near + h) - Ball(near - h)) / 2e-5;
      }
      near += J.partialPivLu().solve(p_MT - Ball(near));
    }
    return near;
  }
};

// Axis positions of a grid of n points over `size`, centred in the travel of 60 mm; in rows along
// x, turning back at their ends.
inline Eigen::Matrix3Xd GridPositions(const Eigen::Vector3d& size, const Eigen::Vector3i& n) {
  Eigen::Matrix3Xd positions(3, n.prod());
  Eigen::Index at = 0;
  const auto place = [&](int axis, int i) {
    return 0.030 + size[axis] * (static_cast<double>(i) / (n[axis] - 1) - 0.5);
  };
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const int back = j % 2 == 0 ? i : n[0] - 1 - i;
        positions.col(at++) = Eigen::Vector3d(place(0, back), place(1, j), place(2, k));
      }
    }
  }
  return positions;
}

inline Eigen::Matrix3Xd RandomPositions(const Eigen::Vector3d& size, int count,
                                        std::uint64_t seed) {
  const random::CounterRandom random(seed, 78);
  Eigen::Matrix3Xd positions(3, count);
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    positions(i % 3, i / 3) =
        0.030 + size[i % 3] * random.Uniform(static_cast<std::uint64_t>(i), -0.5, 0.5);
  }
  return positions;
}

// A run at the positions; `noise` 0 or 1: of encoders and reference as the settings say.
inline simulation::LinkageRun WorldRun(const LinkageWorld& world,
                                       const relm::LinkageSettings& settings,
                                       const Eigen::Matrix3Xd& positions, double noise,
                                       std::uint64_t seed) {
  simulation::LinkageRun run = simulation::RunAt(positions, settings);
  run.name = "world.csv";
  const random::CounterRandom random(seed, 79);
  for (Eigen::Index pose = 0; pose < run.poses(); ++pose) {
    const Eigen::Vector3d at = positions.col(pose);
    const Eigen::Vector3d p_MT(-at.x(), -at.y(), at.z());
    const Eigen::Vector3d near = settings.pivots->Angles(p_MT - settings.X_MB.p, settings.branch);
    run.readings.angles.col(pose) = world.Readings(p_MT, near);
    for (int i = 0; i < 3; ++i) {
      const auto index = static_cast<std::uint64_t>(6 * pose + i);
      run.readings.angles(i, pose) += noise * settings.noise.encoder * random.Normal(index);
      run.reference(i, pose) += noise * settings.noise.reference * random.Normal(index + 3);
    }
  }
  return run;
}

}  // namespace abbe::fusion
