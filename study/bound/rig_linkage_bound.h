// The least error that anybody could make who calibrates the linkage of the virtual rig: the
// Cramer-Rao bound of the data, with what the rig draws from as prior. From the rig's own
// description of its linkage (rig/linkage.h), written out once more with matrices; shares no code
// with relm/, simulation/ and fusion/ and none with the rig.
//
// Unknown: everything that the rig draws. Data: encoder readings and ball positions with white
// noise. Units: m, rad, K. Shapes: poses and places 3 x n in B, the nominal base.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "rig/linkage_settings.h"

namespace abbe::study {

class RigLinkageBound {
 public:
  using Index = Eigen::Index;

  explicit RigLinkageBound(const rig::LinkageSettings& settings) : settings_(settings) {
    const auto drawn = [&](double deviation) {
      deviations_.push_back(deviation);
      return static_cast<Eigen::Index>(deviations_.size()) - 1;
    };
    for (std::size_t i = 0; i < 3; ++i) {
      Pivot& pivot = pivots_[i];
      for (auto& each : pivot.tilt) each = drawn(settings.pivot_angle);
      for (auto& each : pivot.offset) each = drawn(settings.pivot_offset);
      for (auto& direction : pivot.run_out) {
        for (const int order : settings.bearing_harmonics) {
          direction.push_back({order, drawn(settings.bearing), drawn(settings.bearing)});
        }
      }
      pivot.zero = drawn(settings.encoder_offset);
      pivot.encoder.push_back({1, drawn(settings.eccentricity), drawn(settings.eccentricity)});
      for (const int order : settings.graduation_harmonics) {
        pivot.encoder.push_back({order, drawn(settings.graduation), drawn(settings.graduation)});
      }
      pivot.give = drawn(settings.compliance);
    }
    for (auto& each : links_) each = drawn(settings.link);
    for (auto& each : ball_) each = drawn(settings.ball);
    for (auto& each : expansion_) each = drawn(settings.thermal);
    for (auto& each : place_) each = drawn(settings.base_place);
    for (auto& each : angle_) each = drawn(settings.base_angle);
  }

  // Covariance of everything drawn, in units of its deviations, after a calibration with the ball
  // at `places`, warmer than the reference by `warmth`.
  Eigen::MatrixXd Covariance(const Eigen::Matrix3Xd& places, const Eigen::VectorXd& warmth) const {
    const auto n = static_cast<Eigen::Index>(deviations_.size());
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      const Eigen::Vector3d shown = Angles(places.col(i));
      const Eigen::Matrix3d slope = Slope(shown, warmth[i]);
      const Eigen::Matrix3d noise =
          std::pow(settings_.encoder_noise, 2) * slope * slope.transpose() +
          std::pow(settings_.reference_noise, 2) * Eigen::Matrix3d::Identity();
      const Eigen::MatrixXd J = Jacobian(shown, warmth[i]);
      information += J.transpose() * noise.inverse() * J;
    }
    return information.llt().solve(Eigen::MatrixXd::Identity(n, n));
  }

  // Variance of the ball position that a covariance leaves, summed over x, y, z and all places.
  double Variance(const Eigen::MatrixXd& covariance, const Eigen::Matrix3Xd& places,
                  double warmth) const {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      const Eigen::MatrixXd J = Jacobian(Angles(places.col(i)), warmth);
      sum += (J * covariance).cwiseProduct(J).sum();
    }
    return sum;
  }

  // The ball in B for what the encoders show; `x` in units of the deviations.
  Eigen::Vector3d Ball(const Eigen::VectorXd& x, const Eigen::Vector3d& shown,
                       double warmth) const {
    using Eigen::AngleAxisd, Eigen::Isometry3d, Eigen::Translation3d, Eigen::Vector3d;
    const auto at = [&](Eigen::Index i) { return x[i] * deviations_[static_cast<std::size_t>(i)]; };
    const Vector3d X = Vector3d::UnitX(), Y = Vector3d::UnitY(), Z = Vector3d::UnitZ();
    const Vector3d down = settings_.base_rotation.transpose() * settings_.down;
    const Vector3d growth_1 =
        (settings_.expansion + at(expansion_[0])) * warmth * settings_.link_1 * X;
    const Vector3d growth_2 =
        (settings_.expansion + at(expansion_[1])) * warmth * settings_.link_2 * Z;
    const Vector3d elbow = (settings_.link_1 + at(links_[0])) * X;
    const std::array<Vector3d, 3> axes{Z, Y, Y},
        points{Vector3d(0, 0, 0), Vector3d(0, 0, 0), Vector3d(elbow + growth_1)};
    const std::array<Vector3d, 3> weights{Vector3d(0, 0, 0), X, Z};
    Isometry3d moved = Isometry3d::Identity();
    for (std::size_t i = 0; i < 3; ++i) {
      const Pivot& pivot = pivots_[i];
      const Vector3d first = X, second = axes[i].cross(X);
      moved = moved * Translation3d(points[i]) * AngleAxisd(at(pivot.tilt[0]), first) *
              AngleAxisd(at(pivot.tilt[1]), second) *
              Translation3d(at(pivot.offset[0]) * first + at(pivot.offset[1]) * second - points[i]);
      const auto sum = [&](const std::vector<Wave>& waves, double angle) {
        double total = 0.0;
        for (const Wave& wave : waves) {
          total += at(wave.sine) * std::sin(wave.order * angle) +
                   at(wave.cosine) * std::cos(wave.order * angle);
        }
        return total;
      };
      // The turn that the encoder shows as it does.
      double turn = shown[static_cast<Eigen::Index>(i)] - at(pivot.zero);
      for (int pass = 0; pass < 4; ++pass) {
        turn = shown[static_cast<Eigen::Index>(i)] - at(pivot.zero) - sum(pivot.encoder, turn);
      }
      const Vector3d shift =
          sum(pivot.run_out[0], turn) * first + sum(pivot.run_out[1], turn) * second;
      const auto turned = [&](double angle) {
        return Isometry3d(moved * Translation3d(shift + points[i]) * AngleAxisd(angle, axes[i]) *
                          Translation3d(-points[i]));
      };
      const Vector3d torque = (turned(turn).rotation() * weights[i]).cross(down);
      moved = turned(turn + at(pivot.give) * (moved.rotation() * axes[i]).dot(torque));
    }
    const Vector3d p =
        moved * (elbow + Vector3d(at(ball_[0]), at(ball_[1]), settings_.link_2 + at(links_[1])) +
                 growth_1 + growth_2);
    const Vector3d rotated = AngleAxisd(at(angle_[2]), Z) *
                             (AngleAxisd(at(angle_[1]), Y) * (AngleAxisd(at(angle_[0]), X) * p));
    return rotated + Vector3d(at(place_[0]), at(place_[1]), at(place_[2]));
  }

  // By everything drawn, in units of its deviations: a hundredth of them is straight enough.
  Eigen::MatrixXd Jacobian(const Eigen::Vector3d& shown, double warmth) const {
    return BySteps(static_cast<Index>(deviations_.size()), 0.01,
                   [&](const Eigen::VectorXd& x) { return Ball(x, shown, warmth); });
  }

  // By the angles that are shown.
  Eigen::Matrix3d Slope(const Eigen::Vector3d& shown, double warmth) const {
    const auto n = static_cast<Index>(deviations_.size());
    return BySteps(3, 1e-5, [&](const Eigen::VectorXd& step) {
      return Ball(Eigen::VectorXd::Zero(n), shown + step, warmth);
    });
  }

  // The elbow up, by the law of cosines: the nominal linkage.
  Eigen::Vector3d Angles(const Eigen::Vector3d& p) const {
    const double a = settings_.link_1, b = settings_.link_2, distance = p.norm();
    const double reach = std::hypot(p.x(), p.y());
    const double first = std::atan2(p.z(), reach) +
                         std::acos((a * a + distance * distance - b * b) / (2 * a * distance));
    const double second = std::atan2(p.z() - a * std::sin(first), reach - a * std::cos(first));
    return {std::atan2(p.y(), p.x()), -first, M_PI / 2 - second + first};
  }

 private:
  struct Wave {
    int order;
    Index sine, cosine;
  };
  struct Pivot {
    std::array<Index, 2> tilt, offset;
    std::array<std::vector<Wave>, 2> run_out;
    Index zero;
    std::vector<Wave> encoder;
    Index give;
  };

  // Central differences; a column for each entry of a step from zero.
  static Eigen::MatrixXd BySteps(Index n, double step,
                                 const std::function<Eigen::Vector3d(const Eigen::VectorXd&)>& f) {
    Eigen::MatrixXd J(3, n);
    for (Index i = 0; i < n; ++i) {
      const Eigen::VectorXd h = step * Eigen::VectorXd::Unit(n, i);
      J.col(i) = (f(h) - f(-h)) / (2.0 * step);
    }
    return J;
  }

  rig::LinkageSettings settings_;
  std::vector<double> deviations_;
  std::array<Pivot, 3> pivots_{};
  std::array<Index, 2> links_{}, ball_{}, expansion_{};
  std::array<Index, 3> place_{}, angle_{};
};

}  // namespace abbe::study
