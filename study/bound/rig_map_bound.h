// The least error that anybody could make who maps the machine of the virtual rig: the Bayesian
// Cramer-Rao bound of recordings, with what the rig draws from as prior.
//
//   RigMapBound bound(rig_settings, linkage_settings, places);    // 3 x n, axis positions
//   bound.Add(sweep_recording);  bound.Add(linkage_recording);  bound.Add(length_recording);
//   bound.Variance({true, true, false});                          // mean of |error|^2, m^2
//
// The errors of the rig are Gaussian and small, so what a reading says is linear in them: the bound
// is the variance of a Gaussian process given the readings. It is worked out in the space of the
// readings with the covariance functions of rig/gaussian_field.h and rig/noise.h, without any basis
// for the functions; kinematics and head: rig_slopes.h. No code of simulation/, fusion/ and
// machine/, and none of the rig but its settings. Left out: products of small quantities (a gain
// times a gap), quantised encoders, temperatures. Units: m, rad, s.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "rig/rig_settings.h"
#include "study/bound/rig_linkage_bound.h"
#include "study/bound/rig_slopes.h"
#include "study/bound/rig_stays.h"

namespace abbe::study {

class RigMapBound {
 public:
  using MatrixXd = Eigen::MatrixXd;
  using VectorXd = Eigen::VectorXd;
  using Vector3d = Eigen::Vector3d;
  using Index = Eigen::Index;
  enum Kind { kSweep, kLinkage, kLength, kWanted };

  RigMapBound(const rig::RigSettings& machine, const rig::LinkageSettings& linkage,
              const Eigen::Matrix3Xd& places)
      : machine_(machine), slopes_(machine), linkage_settings_(linkage), linkage_(linkage) {
    for (Index i = 0; i < places.cols(); ++i) {
      for (Datum& datum : AtPlace(kWanted, places.col(i))) data_.push_back(std::move(datum));
    }
  }

  // Rows that stand at one place are one reading.
  void Add(const recording::Recording& recording) {
    const std::string kind = recording.Kind();
    if (kind == "sweep") AddSweep(recording);
    if (kind == "linkage") AddLinkage(recording);
    if (kind == "length") AddLengths(recording);
  }

  // Mean over the places of the sum over x, y, z of what these kinds of runs leave.
  double Variance(const std::array<bool, 3>& with) const {
    std::vector<int> known, wanted;
    for (int i = 0; i < static_cast<int>(data_.size()); ++i) {
      const Kind kind = data_[static_cast<std::size_t>(i)].kind;
      if (kind == kWanted) wanted.push_back(i);
      if (kind != kWanted && with[kind]) known.push_back(i);
    }
    const MatrixXd K = Covariance();
    const VectorXd scale = K.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd C = scale.asDiagonal() * K * scale.asDiagonal();
    const Eigen::LLT<MatrixXd> factor{MatrixXd(C(known, known))};
    const MatrixXd half = factor.matrixL().solve(MatrixXd(C(known, wanted)));
    double sum = 0.0;
    for (Index i = 0; i < half.cols(); ++i) {
      sum += K(wanted[i], wanted[i]) * (1.0 - half.col(i).squaredNorm());
    }
    return 3.0 * sum / static_cast<double>(wanted.size());
  }

  // All readings and places, in the order in which they were added: x, y, z of a place; the
  // probes of a stay; x, y, z of a ball; a length.
  MatrixXd Covariance() const {
    const auto n = static_cast<Index>(data_.size());
    MatrixXd K = MatrixXd::Zero(n, n);
    for (int axis = 0; axis < 3; ++axis) {
      for (int motion = 0; motion < 6; ++motion) {
        VectorXd by(n);
        for (Index i = 0; i < n; ++i)
          by[i] = data_[static_cast<std::size_t>(i)].by.motions(axis, motion);
        K += (by * by.transpose()).cwiseProduct(Functions(axis, motion));
      }
    }
    MatrixXd shared(n, Index{RigSlopes::kSharedCount});
    for (Index i = 0; i < n; ++i) shared.row(i) = data_[static_cast<std::size_t>(i)].by.shared;
    K += shared * shared.transpose();
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        K(i, j) += Noise(data_[static_cast<std::size_t>(i)], data_[static_cast<std::size_t>(j)]);
      }
      const double white = data_[static_cast<std::size_t>(i)].white;
      K(i, i) += white * white;
    }
    return K;
  }

 private:
  struct Datum {
    Kind kind = kWanted;
    Vector3d at = Vector3d::Zero();  // where the functions of the three axes are taken
    RigSlopes::Slopes by = {};
    Eigen::RowVectorXd linkage = {};  // by everything drawn of it, in units of the deviations
    int run = 0, probe = 0, stay = 0, component = 0;
    double time = 0.0, length = 0.0, white = 0.0;
    Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();  // of the three readings of a stay
  };

  std::array<Datum, 3> AtPlace(Kind kind, const Vector3d& position) const {
    const auto slopes = slopes_.OfBall(position);
    std::array<Datum, 3> data;
    for (std::size_t i = 0; i < 3; ++i) {
      data[i].kind = kind;
      data[i].at = position;
      data[i].by = slopes[i];
    }
    return data;
  }

  void AddLinkage(const recording::Recording& recording) {
    const Eigen::Matrix3d R = linkage_settings_.base_rotation;
    auto number = static_cast<int>(data_.size());  // of no other stay
    for (const RigStay& stay : RigStaysOf(recording)) {
      const Vector3d ball = slopes_.BallAt(stay.position) - linkage_settings_.base_position;
      const Vector3d shown = linkage_.Angles(R.transpose() * ball);
      const MatrixXd J = R * linkage_.Jacobian(shown, 0.0);
      const Eigen::Matrix3d slope =
          linkage_settings_.encoder_noise * R * linkage_.Slope(shown, 0.0);
      auto data = AtPlace(kLinkage, stay.position);
      for (int i = 0; i < 3; ++i) {
        Datum& datum = data[static_cast<std::size_t>(i)];
        datum.linkage = J.row(i);
        datum.stay = number;
        datum.component = i;
        datum.cov = slope * slope.transpose() / static_cast<double>(stay.rows);
        datum.cov.diagonal().array() += std::pow(linkage_settings_.repeatability, 2);
        data_.push_back(std::move(datum));
      }
      ++number;
    }
  }

  // Lengths along one axis: the other axes stand, so both ends share their functions.
  void AddLengths(const recording::Recording& recording) {
    const auto u = recording.At("u_length_um");
    const double u_scale = 1e-6 * recording.HeaderNumber("u_scale_ppm").value_or(0.0);
    const std::vector<RigStay> stays = RigStaysOf(recording);
    const auto from = AtPlace(kLength, stays[0].position);
    for (std::size_t s = 1; s < stays.size(); ++s) {
      const Vector3d apart = stays[s].position - stays[0].position;
      Index axis = 0;
      apart.cwiseAbs().maxCoeff(&axis);
      const auto to = AtPlace(kLength, stays[s].position);
      const auto i = static_cast<std::size_t>(axis);
      Datum datum = to[i];
      // The first end is where the functions of the axis are zero.
      for (Index other = 0; other < 3; ++other) {
        if (other != axis) datum.by.motions.row(other) -= from[i].by.motions.row(other);
      }
      datum.by.shared -= from[i].by.shared;
      const double sign = machine_.CarriesTarget(static_cast<int>(axis)) ? -1.0 : 1.0;
      datum.by.motions *= sign;
      datum.by.shared *= sign;
      datum.white = 1e-6 * u[stays[s].first];
      datum.length = u_scale * apart.norm();
      data_.push_back(std::move(datum));
    }
  }

  void AddSweep(const recording::Recording& recording) {
    const int axis = recording.HeaderText("axis").value()[0] - 'X';
    for (const RigStay& stay : RigStaysOf(recording)) {
      const auto slopes = slopes_.OfProbes(axis, stay.position[axis]);
      for (std::size_t probe = 0; probe < slopes.size(); ++probe) {
        Datum datum;
        datum.kind = kSweep;
        datum.at = stay.position;
        datum.by = slopes[probe];
        datum.run = axis;
        datum.probe = static_cast<int>(probe);
        datum.time = stay.time;
        datum.white = machine_.white / std::sqrt(static_cast<double>(stay.rows));
        data_.push_back(std::move(datum));
      }
    }
  }

  double Deviation(int axis, int motion) const {
    const rig::ErrorPopulation& p = machine_.population;
    if (motion < 3) return motion == axis ? p.positioning : p.straightness;
    if (motion - 3 == axis) return p.roll;
    return motion - 3 == (axis == 1 ? 0 : 1) ? p.pitch : p.yaw;
  }

  // Covariance of a function at the positions of all readings, after the gauge.
  MatrixXd Functions(int axis, int motion) const {
    constexpr int kCells = 200;         // of the slope of a straightness
    constexpr double kOnePlace = 2e-5;  // m
    const auto [low, high] = machine_.travels[static_cast<std::size_t>(axis)];
    const double sd = Deviation(axis, motion), length = machine_.population.smoothness;
    // Positions that occur; most readings share theirs.
    std::vector<double> places{low};
    std::vector<Index> place_of;
    for (const Datum& datum : data_) {
      const double x = datum.at[axis];
      const auto found = std::find_if(places.begin(), places.end(), [&](double known) {
        return std::abs(known - x) < kOnePlace;
      });
      place_of.push_back(found - places.begin());
      if (found == places.end()) places.push_back(x);
    }
    const bool straightness = motion < 3 && motion != axis;
    const auto n = static_cast<Index>(places.size());
    const Index cells = straightness ? kCells : 0;
    VectorXd x(n + cells), slope = VectorXd::Zero(n + cells);
    x.head(n) = Eigen::Map<const VectorXd>(places.data(), n);
    for (Index i = 0; i < cells; ++i) {
      x[n + i] = low + (high - low) * (static_cast<double>(i) + 0.5) / kCells;
    }
    if (straightness) {
      const VectorXd off = x.tail(cells).array() - 0.5 * (low + high);
      slope.tail(cells) = off / off.squaredNorm();
    }
    MatrixXd K(n + cells, n + cells);
    for (Index j = 0; j < K.cols(); ++j) {
      K.col(j) = sd * sd * (-0.5 * ((x.array() - x[j]) / length).square()).exp();
    }
    MatrixXd G = MatrixXd::Identity(n, n + cells);
    G.col(0).array() -= 1.0;
    const VectorXd along = x.head(n).array() - low;
    G -= along * slope.transpose();
    MatrixXd V = G * K * G.transpose();
    if (motion == axis) {
      V += std::pow(machine_.population.scale, 2) * along * along.transpose();
    }
    return V(place_of, place_of);
  }

  // What two readings of one kind have in common besides the machine and the head.
  double Noise(const Datum& a, const Datum& b) const {
    if (a.kind != b.kind) return 0.0;
    double sum = 0.0;
    if (a.kind == kLinkage) {
      sum += a.linkage.dot(b.linkage);
      if (a.stay == b.stay) sum += a.cov(a.component, b.component);
    }
    if (a.kind == kLength) sum += a.length * b.length;
    if (a.kind != kSweep) return sum;
    if (a.run == b.run && a.probe == b.probe) {
      sum +=
          std::pow(machine_.drift, 2) * std::exp(-std::abs(a.time - b.time) / machine_.drift_time);
    }
    if (a.by.face == b.by.face) {
      const double apart = (a.by.hit - b.by.hit).norm() / machine_.form_length;
      sum += std::pow(machine_.form, 2) * std::exp(-0.5 * apart * apart);
    }
    return sum;
  }

  const rig::RigSettings machine_;
  const RigSlopes slopes_;
  const rig::LinkageSettings linkage_settings_;
  const RigLinkageBound linkage_;
  std::vector<Datum> data_;
};

}  // namespace abbe::study
