// The linkage of the virtual rig, drawn by a seed from the tolerances of the machine file: two
// links, three pivots, a ball. Its angles close the loop exactly for a given position of the ball.
//
// Built from axes in space, nothing linearised: pivot i turns everything after it by a finite angle
// about its own line, which runs out with the angle and yields under gravity; links grow with the
// temperature. The drawn angles and offsets of a pivot displace all that is mounted on it. At zero
// angles the nominal axes are z through the origin, y through the origin and y through (L1, 0, 0),
// and the ball is at (L1, 0, L2); frame B, the base. It shares no code with the models that are
// tested against it.
//
// An encoder shows turn + zero + eccentricity and graduation harmonics of the turn, without noise.
// Units: m, rad, degC. Failure: InputError for a position out of reach, NumericalError when the
// loop does not close.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "rig/hidden_effect.h"
#include "rig/linkage_parts.h"
#include "rig/linkage_settings.h"
#include "rig/rotation.h"

namespace abbe::rig {

class Linkage {
 public:
  // `base`: 0, or another mounting of the base, drawn anew. Hidden effects that are constants of
  // the linkage are built in here.
  Linkage(const LinkageSettings& settings, std::uint64_t seed, const HiddenEffects& hidden = {},
          std::uint64_t base = 0);

  const LinkageSettings& settings() const { return settings_; }
  const std::array<PivotTruth, kPivots>& pivots() const { return parts_.pivots; }
  const Eigen::Vector3d& ball() const { return ball_; }  // in B at zero angles
  const std::array<double, 2>& expansion() const { return parts_.expansion; }  // 1/K, of the links
  const Displacement& base() const { return base_; }                           // takes B to M

  // p_B of the ball for turns of the pivots.
  Eigen::Vector3d BallAt(const Eigen::Vector3d& turns, double temperature) const;
  // The turns that put the ball at p_B, to 1e-13 m.
  Eigen::Vector3d TurnsFor(const Eigen::Vector3d& p_B, double temperature) const;
  // The angles of the encoders at these turns.
  Eigen::Vector3d EncodersAt(const Eigen::Vector3d& turns) const;
  // The turns that put the ball at p_M, and the angles of the encoders there.
  Eigen::Vector3d TurnsForPlace(const Eigen::Vector3d& p_M, double temperature) const;
  Eigen::Vector3d EncodersFor(const Eigen::Vector3d& p_M, double temperature) const;

 private:
  // The state of the chain at some turns.
  struct Posture {
    std::array<Eigen::Vector3d, kPivots> point, direction;  // of the axes, as they stand now
    Eigen::Vector3d ball;
  };

  Posture PostureAt(const Eigen::Vector3d& turns, double temperature) const;
  Eigen::Vector3d Guess(const Eigen::Vector3d& p_B) const;

  LinkageSettings settings_;
  LinkageParts parts_;
  Eigen::Vector3d ball_;
  Displacement base_;
  Eigen::Vector3d down_B_;
};

}  // namespace abbe::rig
