// The Cramer-Rao bound of an axis sweep, from what the rig states about itself: the time of every
// reading, its noise, its tolerances and the first-order readings of the head (Kweon, Liu and Yang,
// equations 2 to 12; docs/theory-head.md for a head that moves). Shares no code with the reduction
// and takes no dwell, no mean and no uncertainty from it.
//
// Unknown: five errors at each station above the first, at the axis reference, the same from both
// directions; the zero of each probe. Random with known covariance:
//   noise     white in every reading + a slow drift of each probe, Ornstein-Uhlenbeck
//   form      of the target's faces, a Gaussian process
//   effects   gains, places of the probes, installation of the head: normal, constant in a sweep
// Five probes and five errors: the expected readings at all stations are as many as the unknowns,
// so the bound of those carries over to these by a change of variables, with form and effects added
// as they are. Units: m, rad. Shapes: component x station, components [EA EB EC, two
// straightnesses].
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <vector>

#include "rig/motion.h"
#include "rig/world.h"

namespace abbe::probes {

class CramerRaoBound {
 public:
  // `rate`: readings of each probe in a second.
  CramerRaoBound(const rig::RigSettings& settings, int axis, double rate)
      : settings_(settings),
        axis_(axis),
        plan_(*settings.sweeps[static_cast<std::size_t>(axis)]),
        stations_(static_cast<Eigen::Index>(plan_.stations.size())),
        from_means_(Gauge() * Design().inverse()) {
    const Eigen::MatrixXd of_probe = NoiseInformation(rate).inverse();
    Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(5 * stations_, 5 * stations_);
    for (Eigen::Index p = 0; p < 5; ++p) {
      noise.block(p * stations_, p * stations_, stations_, stations_) = of_probe;
    }
    noise_ = Variances(noise);
    form_ = Variances(Form());
  }

  // Standard deviations: an angle counts from the first station, a straightness from its
  // least-squares line.
  Eigen::MatrixXd OfNoise() const { return noise_.cwiseSqrt(); }
  // `world` says how large the errors are that gains and places act on.
  Eigen::MatrixXd OfAll(const rig::World& world) const {
    const Eigen::VectorXd effects = (from_means_ * Effects(world)).rowwise().squaredNorm();
    return (noise_ + form_ + Table(effects)).cwiseSqrt();
  }

  // In the same gauge.
  Eigen::MatrixXd Truth(const rig::World& world) const {
    Eigen::VectorXd errors(5 * (stations_ - 1) + 5);
    for (Eigen::Index i = 1; i < stations_; ++i) {
      errors.segment<5>(Unknown(0, i)) = AtReference(world, i) - AtReference(world, 0);
    }
    errors.tail<5>().setZero();
    return Table(Gauge() * errors);
  }

 private:
  using Row = Eigen::Matrix<double, 1, 5>;

  // Row of the mean reading of a probe at a station; column of an error above the first station.
  Eigen::Index At(Eigen::Index probe, Eigen::Index i) const { return probe * stations_ + i; }
  static Eigen::Index Unknown(Eigen::Index c, Eigen::Index i) { return 5 * (i - 1) + c; }
  double Travel(Eigen::Index i) const {
    return plan_.stations[static_cast<std::size_t>(i)] - plan_.first();
  }
  const rig::ProbePlace& Place(Eigen::Index probe) const {
    return settings_.probes[static_cast<std::size_t>(probe)];
  }
  bool TargetMoves() const { return settings_.CarriesTarget(axis_); }
  Eigen::MatrixXd Table(const Eigen::VectorXd& list) const {
    return list.reshaped(stations_, 5).transpose();
  }
  Eigen::MatrixXd Variances(const Eigen::MatrixXd& V) const {
    return Table((from_means_ * V).cwiseProduct(from_means_).rowwise().sum());
  }

  // Fisher information of all readings of one probe about its expected reading m at each station.
  // The drift d at each reading is eliminated: its precision is tridiagonal, since the process is
  // Markov. A reading at station i is m_i + d + white.
  Eigen::MatrixXd NoiseInformation(double rate) const {
    const rig::SweepMotion motion(
        plan_, {.acceleration = settings_.acceleration, .lag = settings_.lag}, plan_.first());
    const double white = 1.0 / (settings_.white * settings_.white);
    const double drift = 1.0 / (settings_.drift * settings_.drift);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(stations_, stations_);
    Eigen::VectorXd coupled = Eigen::VectorXd::Zero(stations_);
    double pivot = 0.0, before = -1.0;
    for (const auto& stand : motion.standstills()) {
      const auto station = static_cast<Eigen::Index>(stand.visit.station);
      for (double tick = std::ceil((stand.start + plan_.settle) * rate); tick < stand.end * rate;
           ++tick) {
        const double time = tick / rate;
        if (before < 0.0) {
          pivot = drift;
        } else {  // d = kept * (d before) + what is fresh; the d before is eliminated
          const double kept = std::exp((before - time) / settings_.drift_time);
          const double fresh = drift / (1.0 - kept * kept);
          pivot += fresh * kept * kept;
          J -= coupled * coupled.transpose() / pivot;
          coupled *= fresh * kept / pivot;
          pivot = fresh - fresh * kept * fresh * kept / pivot;
        }
        pivot += white;
        coupled[station] += white;
        J(station, station) += white;
        before = time;
      }
    }
    return J - coupled * coupled.transpose() / pivot;
  }

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

  // Expected readings from the unknowns; square.
  Eigen::MatrixXd Design() const {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(5 * stations_, 5 * stations_);
    const auto map = HeadFromReference();
    for (Eigen::Index p = 0; p < 5; ++p) {
      for (Eigen::Index i = 0; i < stations_; ++i) {
        H(At(p, i), 5 * (stations_ - 1) + p) = 1.0;
        if (i > 0) H.block<1, 5>(At(p, i), Unknown(0, i)) = ByHeadErrors(p, Travel(i)) * map;
      }
    }
    return H;
  }

  // Errors in the gauge from the unknowns.
  Eigen::MatrixXd Gauge() const {
    Eigen::MatrixXd line(stations_, 2);
    for (Eigen::Index i = 0; i < stations_; ++i) line.row(i) << 1.0, Travel(i);
    const Eigen::MatrixXd off_line = Eigen::MatrixXd::Identity(stations_, stations_) -
                                     line * (line.transpose() * line).inverse() * line.transpose();
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(5 * stations_, 5 * stations_);
    for (Eigen::Index c = 0; c < 5; ++c) {
      for (Eigen::Index i = 1; i < stations_; ++i) {
        if (c < 3) {
          G(At(c, i), Unknown(c, i)) = 1.0;
        } else {
          G.block(At(c, 0), Unknown(c, i), stations_, 1) = off_line.col(i);
        }
      }
    }
    return G;
  }

  // Covariance of the mean readings by the form of the two faces.
  Eigen::MatrixXd Form() const {
    Eigen::MatrixXd V = Eigen::MatrixXd::Zero(5 * stations_, 5 * stations_);
    const double sense = TargetMoves() ? -1.0 : 1.0;
    for (Eigen::Index p = 0; p < 5; ++p) {
      for (Eigen::Index q = 0; q < 5; ++q) {
        if (Place(p).top != Place(q).top) continue;
        for (Eigen::Index i = 0; i < stations_; ++i) {
          for (Eigen::Index j = 0; j < stations_; ++j) {
            const double u = Place(p).along - Place(q).along + sense * (Travel(i) - Travel(j));
            const double v = Place(p).across - Place(q).across;
            const double far = (u * u + v * v) / (settings_.form_length * settings_.form_length);
            V(At(p, i), At(q, j)) = settings_.form * settings_.form * std::exp(-far / 2.0);
          }
        }
      }
    }
    return V;
  }

  Eigen::Matrix<double, 5, 1> AtReference(const rig::World& world, Eigen::Index i) const {
    const auto motions = world.ErrorsOf(axis_, plan_.stations[static_cast<std::size_t>(i)]);
    Eigen::Matrix<double, 5, 1> errors;
    errors << motions.tail<3>(), motions[(axis_ == 0) ? 1 : 0], motions[(axis_ == 2) ? 1 : 2];
    return errors;
  }

  // Mean readings by one standard deviation of five gains, ten places, yaw, pitch and three offsets
  // of the head.
  Eigen::MatrixXd Effects(const rig::World& world) const {
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(5 * stations_, 20);
    const auto map = HeadFromReference();
    const double sign = TargetMoves() ? 1.0 : -1.0;
    Eigen::Vector3d command = settings_.StartOf(axis_);
    const rig::Readings zero = world.TrueGaps(axis_, command);
    for (Eigen::Index i = 0; i < stations_; ++i) {
      command[axis_] = plan_.stations[static_cast<std::size_t>(i)];
      const rig::Readings gaps = world.TrueGaps(axis_, command);
      const Eigen::Matrix<double, 5, 1> e = map * (AtReference(world, i) - AtReference(world, 0));
      for (Eigen::Index p = 0; p < 5; ++p) {
        const auto& [top, along, across, range] = Place(p);
        const auto at = static_cast<std::size_t>(p);
        // How the reading changes with the place of the probe, along u and across.
        const double by_along = sign * (top ? -e[1] : e[2]);
        const double by_across = sign * (top ? e[0] : -e[0]);
        auto row = S.row(At(p, i));
        row[p] = settings_.gain * (gaps[at] - zero[at]);
        row[5 + 2 * p] = settings_.probe_position * by_along;
        row[6 + 2 * p] = settings_.probe_position * by_across;
        // The head turned: about n the top probes move in their plane, about s the side probes.
        row[top ? 15 : 16] =
            settings_.installation_angle *
            (top ? -across * by_along + along * by_across : across * by_along - along * by_across);
        row[17] = settings_.installation_offset * by_along;
        row[top ? 18 : 19] = settings_.installation_offset * by_across;
      }
    }
    return S;
  }

  rig::RigSettings settings_;
  int axis_;
  hal::SweepPlan plan_;
  Eigen::Index stations_;
  Eigen::MatrixXd from_means_;    // errors in the gauge from mean readings
  Eigen::MatrixXd noise_, form_;  // variances
};

}  // namespace abbe::probes
