// The Cramer-Rao bound of an axis sweep, by dense linear algebra from what the rig states about
// itself: its own first-order model of the head (Kweon, Liu and Yang, equations 8 to 12), its noise
// and its tolerances. Shares no code with the reduction.
//
// Unknown: five errors per station at the axis reference, the same from both directions, and the
// zero of each probe. Random with known covariance: white noise and drift of every dwell, the form
// of the faces, gains, places of the probes and installation of the head.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>
#include <array>
#include <cmath>
#include <vector>

#include "rig/campaign.h"
#include "rig/motion.h"
#include "rig/world.h"

namespace abbe::probes {

class CramerRaoBound {
 public:
  CramerRaoBound(const rig::RigSettings& settings, int axis)
      : settings_(settings), axis_(axis), plan_(*settings.sweeps[static_cast<std::size_t>(axis)]) {
    const rig::SweepMotion motion(
        plan_, {.acceleration = settings.acceleration, .lag = settings.lag}, plan_.first());
    for (const auto& stand : motion.standstills()) {
      const double counted = stand.end - stand.start - plan_.settle;
      dwells_.push_back({stand.end - counted / 2.0, counted, counted * rig::CampaignOptions{}.rate,
                         static_cast<Eigen::Index>(stand.visit.station)});
    }
    stations_ = static_cast<Eigen::Index>(plan_.stations.size());
    Design();
    noise_.compute(Noise());
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(noise_.matrixL().solve(H_));
    Q_ = qr.householderQ() * Eigen::MatrixXd::Identity(H_.rows(), H_.cols());
    R_ = qr.matrixQR().topRows(H_.cols()).triangularView<Eigen::Upper>();
    const Eigen::MatrixXd inverse =
        R_.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(R_.rows(), R_.cols()));
    without_effects_ = inverse * inverse.transpose();
  }

  // Standard deviations, component x station: angles from the first station, straightnesses from
  // their least-squares line. `world` says how large the errors are that gains and places act on.
  Eigen::MatrixXd Deviations(const rig::World& world) const {
    // White readings L^-1 (H x + S z), z of unit variance: the part of S that the unknowns cannot
    // take up tells about z, the rest of z spoils them.
    const Eigen::MatrixXd S = noise_.matrixL().solve(RandomEffects(world));
    const Eigen::MatrixXd taken = Q_.transpose() * S;
    const Eigen::MatrixXd left = S - Q_ * taken;
    const Eigen::MatrixXd seen =
        Eigen::MatrixXd::Identity(S.cols(), S.cols()) + left.transpose() * left;
    const Eigen::MatrixXd by_effect = R_.triangularView<Eigen::Upper>().solve(taken);
    const Eigen::MatrixXd V =
        without_effects_ + by_effect * seen.llt().solve(by_effect.transpose());
    Eigen::MatrixXd deviations(5, stations_);
    for (Eigen::Index c = 0; c < 5; ++c) {
      Eigen::MatrixXd C = Eigen::MatrixXd::Zero(stations_, stations_);
      for (Eigen::Index i = 1; i < stations_; ++i) {
        for (Eigen::Index j = 1; j < stations_; ++j) C(i, j) = V(Unknown(c, i), Unknown(c, j));
      }
      if (c >= 3) C = FromLine() * C * FromLine().transpose();
      deviations.row(c) = C.diagonal().cwiseMax(0.0).cwiseSqrt().transpose();
    }
    return deviations;
  }

  // Component x station, at the axis reference in the same gauge.
  Eigen::MatrixXd Truth(const rig::World& world) const {
    Eigen::MatrixXd truth(5, stations_);
    for (Eigen::Index i = 0; i < stations_; ++i) truth.col(i) = AtReference(world, i);
    for (Eigen::Index c = 0; c < 3; ++c) truth.row(c).array() -= truth(c, 0);
    truth.bottomRows<2>() = truth.bottomRows<2>() * FromLine().transpose();
    return truth;
  }

 private:
  using Row = Eigen::Matrix<double, 1, 5>;
  struct Dwell {
    double time, seconds, readings;
    Eigen::Index station;
  };

  Eigen::Index Count() const { return static_cast<Eigen::Index>(dwells_.size()); }
  // Row of a probe and dwell; column of a component and station above the first.
  Eigen::Index At(Eigen::Index probe, Eigen::Index dwell) const { return probe * Count() + dwell; }
  Eigen::Index Unknown(Eigen::Index c, Eigen::Index i) const { return 5 * (i - 1) + c; }
  double Travel(Eigen::Index station) const {
    return plan_.stations[static_cast<std::size_t>(station)] - plan_.first();
  }
  const rig::ProbePlace& Place(Eigen::Index probe) const {
    return settings_.probes[static_cast<std::size_t>(probe)];
  }
  bool TargetMoves() const { return settings_.CarriesTarget(axis_); }

  // The reading of a probe by [roll pitch yaw side normal] in the head frame at the target.
  Row ByHeadErrors(Eigen::Index probe, double d) const {
    const auto& [top, along, across, range] = Place(probe);
    const double lever = TargetMoves() ? d - along : -along;
    Row row;
    if (top) {
      row << across, lever, 0, 0, 1;
    } else {
      row << -across, 0, -lever, 1, 0;
    }
    return TargetMoves() ? row : Row(-row);
  }

  // Head errors from [EA EB EC, two straightnesses] at the axis reference.
  Eigen::Matrix<double, 5, 5> HeadFromReference() const {
    const rig::HeadPlace& place = settings_.head[static_cast<std::size_t>(axis_)];
    const Eigen::Vector3d r = place.position - settings_.reference - settings_.StartOf(axis_);
    Eigen::Matrix<double, 3, 3> arm;  // w x r
    arm << 0, r.z(), -r.y(), -r.z(), 0, r.x(), r.y(), -r.x(), 0;
    Eigen::Matrix<double, 3, 5> shift = Eigen::Matrix<double, 3, 5>::Zero();
    shift.leftCols<3>() = arm;
    shift((axis_ == 0) ? 1 : 0, 3) = 1;
    shift((axis_ == 2) ? 1 : 2, 4) = 1;
    Eigen::Matrix<double, 5, 5> map = Eigen::Matrix<double, 5, 5>::Zero();
    map.topLeftCorner<3, 3>() = place.rotation.transpose();
    map.bottomRows<2>() = (place.rotation.transpose() * shift).bottomRows<2>();
    return map;
  }

  void Design() {
    H_ = Eigen::MatrixXd::Zero(5 * Count(), 5 * (stations_ - 1) + 5);
    const auto map = HeadFromReference();
    for (Eigen::Index p = 0; p < 5; ++p) {
      for (Eigen::Index k = 0; k < Count(); ++k) {
        const Eigen::Index i = dwells_[static_cast<std::size_t>(k)].station;
        H_(At(p, k), 5 * (stations_ - 1) + p) = 1.0;
        if (i > 0) H_.block<1, 5>(At(p, k), Unknown(0, i)) = ByHeadErrors(p, Travel(i)) * map;
      }
    }
  }

  Eigen::MatrixXd Noise() const {
    Eigen::MatrixXd V = Eigen::MatrixXd::Zero(5 * Count(), 5 * Count());
    const double sense = TargetMoves() ? -1.0 : 1.0;
    for (Eigen::Index p = 0; p < 5; ++p) {
      for (Eigen::Index q = 0; q < 5; ++q) {
        if (Place(p).top != Place(q).top) continue;
        for (Eigen::Index k = 0; k < Count(); ++k) {
          for (Eigen::Index l = 0; l < Count(); ++l) {
            const Dwell &a = dwells_[static_cast<std::size_t>(k)],
                        &b = dwells_[static_cast<std::size_t>(l)];
            const double u =
                Place(p).along - Place(q).along + sense * (Travel(a.station) - Travel(b.station));
            const double v = Place(p).across - Place(q).across;
            const double form = (u * u + v * v) / (settings_.form_length * settings_.form_length);
            double& entry = V(At(p, k), At(q, l));
            entry = settings_.form * settings_.form * std::exp(-form / 2.0);
            if (p != q) continue;
            entry += settings_.drift * settings_.drift *
                     (k == l ? MeanOfDrift(a.seconds / settings_.drift_time)
                             : std::exp(-std::abs(a.time - b.time) / settings_.drift_time));
            if (k == l) entry += settings_.white * settings_.white / a.readings;
          }
        }
      }
    }
    return V;
  }

  // The variance of the mean over a time t of an Ornstein-Uhlenbeck process of unit variance and
  // time.
  static double MeanOfDrift(double t) { return 2.0 * (t - 1.0 + std::exp(-t)) / (t * t); }

  Eigen::Matrix<double, 5, 1> AtReference(const rig::World& world, Eigen::Index station) const {
    const auto motions = world.ErrorsOf(axis_, plan_.stations[static_cast<std::size_t>(station)]);
    Eigen::Matrix<double, 5, 1> errors;
    errors << motions.tail<3>(), motions[(axis_ == 0) ? 1 : 0], motions[(axis_ == 2) ? 1 : 2];
    return errors;
  }

  // Columns of standard deviations: five gains, ten places, yaw, pitch and three offsets of the
  // head.
  Eigen::MatrixXd RandomEffects(const rig::World& world) const {
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(5 * Count(), 20);
    const auto map = HeadFromReference();
    const Eigen::Matrix<double, 5, 1> first = AtReference(world, 0);
    const double sign = TargetMoves() ? 1.0 : -1.0;
    Eigen::Vector3d command = settings_.StartOf(axis_);
    const rig::Readings zero = world.TrueGaps(axis_, command);
    for (Eigen::Index i = 0; i < stations_; ++i) {
      command[axis_] = plan_.stations[static_cast<std::size_t>(i)];
      const rig::Readings gaps = world.TrueGaps(axis_, command);
      const Eigen::Matrix<double, 5, 1> e = map * (AtReference(world, i) - first);
      for (Eigen::Index p = 0; p < 5; ++p) {
        const auto& [top, along, across, range] = Place(p);
        const auto at = static_cast<std::size_t>(p);
        // How the reading changes with the place of the probe, along u and across.
        const double by_along = sign * (top ? -e[1] : e[2]);
        const double by_across = sign * (top ? e[0] : -e[0]);
        Eigen::Matrix<double, 1, 20> row = Eigen::Matrix<double, 1, 20>::Zero();
        row[p] = settings_.gain * (gaps[at] - zero[at]);
        row[5 + 2 * p] = settings_.probe_position * by_along;
        row[6 + 2 * p] = settings_.probe_position * by_across;
        // The head turned: about n the top probes move in their plane, about s the side probes.
        row[top ? 15 : 16] =
            settings_.installation_angle *
            (top ? -across * by_along + along * by_across : across * by_along - along * by_across);
        row[17] = settings_.installation_offset * by_along;
        row[top ? 18 : 19] = settings_.installation_offset * by_across;
        for (Eigen::Index k = 0; k < Count(); ++k) {
          if (dwells_[static_cast<std::size_t>(k)].station == i) S.row(At(p, k)) = row;
        }
      }
    }
    return S;
  }

  // Takes the least-squares line off.
  Eigen::MatrixXd FromLine() const {
    Eigen::MatrixXd A(stations_, 2);
    for (Eigen::Index i = 0; i < stations_; ++i) A.row(i) << 1.0, Travel(i);
    return Eigen::MatrixXd::Identity(stations_, stations_) -
           A * (A.transpose() * A).inverse() * A.transpose();
  }

  rig::RigSettings settings_;
  int axis_;
  hal::SweepPlan plan_;
  std::vector<Dwell> dwells_;
  Eigen::Index stations_ = 0;
  Eigen::MatrixXd H_;
  Eigen::LLT<Eigen::MatrixXd> noise_;
  Eigen::MatrixXd Q_, R_, without_effects_;
};

}  // namespace abbe::probes
