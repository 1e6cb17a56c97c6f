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
// for the functions; kinematics and head are written out once more, differentiated by steps. No
// code of simulation/, fusion/ and machine/, and none of the rig but its settings.
// Left out: products of small quantities (a gain times a gap), quantised encoders, temperatures.
// Units: m, rad, s.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "rig/rig_settings.h"
#include "tests/fusion/rig_linkage_bound.h"

namespace abbe::fusion {

class RigMapBound {
 public:
  using MatrixXd = Eigen::MatrixXd;
  using VectorXd = Eigen::VectorXd;
  using Vector3d = Eigen::Vector3d;
  using Index = Eigen::Index;
  enum Kind { kSweep, kLinkage, kLength, kWanted };

  RigMapBound(const rig::RigSettings& machine, const rig::LinkageSettings& linkage,
              const Eigen::Matrix3Xd& places)
      : machine_(machine), linkage_settings_(linkage), linkage_(linkage) {
    for (Index i = 0; i < places.cols(); ++i) AddPlace(kWanted, places.col(i));
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

 private:
  // One reading: what it depends on, to first order.
  struct Datum {
    Kind kind;
    Eigen::Matrix<double, 3, 6> motions = Eigen::Matrix<double, 3, 6>::Zero();  // by axis
    Vector3d at = Vector3d::Zero();  // where the functions of the three axes are taken
    VectorXd shared;                 // by what all readings share, in its deviations
    Eigen::Matrix<double, 1, Eigen::Dynamic> linkage;  // the same for the linkage
    int run = 0, probe = 0, face = -1, stay = 0, component = 0;
    double time = 0.0, length = 0.0, white = 0.0;
    Eigen::Vector2d hit = Eigen::Vector2d::Zero();
    Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();  // of the three readings of a stay
  };

  // Shared by all: squareness, then of the head and the target.
  enum Shared {
    kSquare = 0,
    kAlong = 3,
    kAcross = 8,
    kDepth = 13,
    kGain = 18,
    kTurn = 23,
    kPlace = 32,
    kSet = 41,
    kTilt = 47,
    kFaces = 50,
    kSharedCount = 53
  };

  VectorXd SharedDeviations() const {
    VectorXd sd(Index{kSharedCount});
    sd.segment<3>(kSquare).setConstant(machine_.population.squareness);
    sd.segment<15>(kAlong).setConstant(machine_.probe_position);
    sd.segment<5>(kGain).setConstant(machine_.gain);
    sd.segment<9>(kTurn).setConstant(machine_.installation_angle);
    sd.segment<9>(kPlace).setConstant(machine_.installation_offset);
    sd.segment<6>(kSet).setConstant(machine_.gap_setting);
    sd.segment<3>(kTilt).setConstant(machine_.target_tilt / std::sqrt(3.0));
    sd.segment<3>(kFaces).setConstant(machine_.u_target_squareness);
    return sd;
  }

  static Eigen::Matrix3d Turn(const Vector3d& w) {
    const double angle = w.norm();
    if (angle == 0.0) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  }

  // Of the body at the end of these axes, from the bed; `motions` of the axes at `position`.
  Eigen::Isometry3d Body(const std::string& axes, const Vector3d& position,
                         const Eigen::Matrix<double, 3, 6>& motions,
                         const Vector3d& squareness) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (const char letter : axes) {
      const int axis = letter - 'X';
      Vector3d line = Vector3d::Unit(axis);
      if (axis == 1) line = Turn({0, 0, squareness[2]}) * line;
      if (axis == 2) line = Turn({squareness[0], squareness[1], 0}) * line;
      const Vector3d shift = motions.row(axis).head<3>(), turn = motions.row(axis).tail<3>();
      pose = pose * Eigen::Translation3d(machine_.reference + position[axis] * line + shift) *
             Eigen::Quaterniond(Turn(turn)) * Eigen::Translation3d(-machine_.reference);
    }
    return pose;
  }
  Eigen::Isometry3d Work(const Vector3d& position, const Eigen::Matrix<double, 3, 6>& motions,
                         const Vector3d& squareness) const {
    const std::string& axes = machine_.workpiece_axes;
    return Body({axes.rbegin(), axes.rend()}, position, motions, squareness);
  }

  // Derivatives of f at zero by central steps of these sizes.
  static MatrixXd BySteps(const VectorXd& steps,
                          const std::function<VectorXd(const VectorXd&)>& f) {
    MatrixXd J(f(VectorXd::Zero(steps.size())).size(), steps.size());
    for (Index i = 0; i < steps.size(); ++i) {
      const VectorXd h = steps[i] * VectorXd::Unit(steps.size(), i);
      J.col(i) = (f(h) - f(-h)) / (2.0 * steps[i]);
    }
    return J;
  }
  static Eigen::Matrix<double, 3, 6> Unpack(const VectorXd& x) {
    return Eigen::Map<const Eigen::Matrix<double, 6, 3>>(x.data()).transpose();
  }

  // Where the ball stands in the workpiece: three readings without noise.
  std::array<Datum, 3> PlaceData(Kind kind, const Vector3d& position) const {
    VectorXd steps(21);
    steps.setConstant(1e-6);
    const MatrixXd J = BySteps(steps, [&](const VectorXd& x) -> VectorXd {
      const Vector3d squareness = x.tail<3>();
      const Vector3d tool =
          Body(machine_.tool_axes, position, Unpack(x), squareness) * Vector3d(0, 0, 0);
      return Work(position, Unpack(x), squareness).inverse() * tool;
    });
    std::array<Datum, 3> data;
    for (Index i = 0; i < 3; ++i) {
      Datum& datum = data[static_cast<std::size_t>(i)];
      datum.kind = kind;
      datum.at = position;
      datum.motions = Unpack(J.row(i).head<18>().transpose());
      datum.shared = VectorXd::Zero(Index{kSharedCount});
      datum.shared.segment<3>(kSquare) =
          machine_.population.squareness * J.row(i).tail<3>().transpose();
    }
    return data;
  }
  void AddPlace(Kind kind, const Vector3d& position) {
    for (Datum& datum : PlaceData(kind, position)) data_.push_back(std::move(datum));
  }

  struct Stay {
    std::size_t first, rows;
    Vector3d position;
    double time;
  };
  static std::vector<Stay> StaysOf(const recording::Recording& recording) {
    const auto x = recording.At("x_mm"), y = recording.At("y_mm"), z = recording.At("z_mm"),
               time = recording.At("time_s"), pass = recording.At("pass"),
               direction = recording.At("direction");
    std::vector<Stay> stays;
    for (std::size_t row = 0; row < recording.rows(); ++row) {
      const Vector3d here = 1e-3 * Vector3d(x[row], y[row], z[row]);
      const bool same = row > 0 && (here - stays.back().position).norm() < 2e-5 &&
                        pass[row] == pass[row - 1] && direction[row] == direction[row - 1];
      if (!same) stays.push_back({row, 0, here, 0.0});
      Stay& stay = stays.back();
      ++stay.rows;
      stay.time += (time[row] - stay.time) / static_cast<double>(stay.rows);
    }
    return stays;
  }

  void AddLinkage(const recording::Recording& recording) {
    for (const Stay& stay : StaysOf(recording)) {
      auto data = PlaceData(kLinkage, stay.position);
      const Vector3d ball =
          Work(stay.position, Unpack(VectorXd::Zero(18)), Vector3d::Zero()).inverse() *
          (Body(machine_.tool_axes, stay.position, Unpack(VectorXd::Zero(18)), Vector3d::Zero()) *
           Vector3d(0, 0, 0));
      const Eigen::Matrix3d R = linkage_settings_.base_rotation;
      const Vector3d shown =
          linkage_.Angles(R.transpose() * (ball - linkage_settings_.base_position));
      const MatrixXd J = R * linkage_.Jacobian(shown, 0.0);
      const Eigen::Matrix3d slope = R * linkage_.Slope(shown, 0.0);
      const double encoder = linkage_settings_.encoder_noise;
      const Eigen::Matrix3d cov =
          encoder * encoder / static_cast<double>(stay.rows) * slope * slope.transpose() +
          std::pow(linkage_settings_.repeatability, 2) * Eigen::Matrix3d::Identity();
      for (int i = 0; i < 3; ++i) {
        Datum& datum = data[static_cast<std::size_t>(i)];
        datum.linkage = J.row(i);
        datum.stay = static_cast<int>(data_.size()) / 3 + 1;
        datum.component = i;
        datum.cov = cov;
      }
      for (Datum& datum : data) datum.stay = data[0].stay;
      for (Datum& datum : data) data_.push_back(std::move(datum));
    }
  }

  // Of lengths along one axis: the other axes stand, so both ends share their functions.
  void AddLengths(const recording::Recording& recording) {
    const auto u = recording.At("u_length_um");
    const double u_scale = 1e-6 * recording.HeaderNumber("u_scale_ppm").value_or(0.0);
    const std::vector<Stay> stays = StaysOf(recording);
    const auto from = PlaceData(kLength, stays[0].position);
    for (std::size_t s = 1; s < stays.size(); ++s) {
      const Vector3d apart = stays[s].position - stays[0].position;
      Index axis = 0;
      apart.cwiseAbs().maxCoeff(&axis);
      const auto to = PlaceData(kLength, stays[s].position);
      const auto i = static_cast<std::size_t>(axis);
      Datum datum = to[i];
      // The first end is where the functions of the axis are zero.
      for (Index other = 0; other < 3; ++other) {
        if (other != axis) datum.motions.row(other) -= from[i].motions.row(other);
      }
      datum.shared -= from[i].shared;
      const double sign = machine_.CarriesTarget(static_cast<int>(axis)) ? -1.0 : 1.0;
      datum.motions *= sign;
      datum.shared *= sign;
      datum.white = 1e-6 * u[stays[s].first];
      datum.length = u_scale * apart.norm();
      data_.push_back(std::move(datum));
    }
  }

  // The readings of the five probes; x = [six motions of the swept axis | shared].
  VectorXd Readings(int axis, const Vector3d& start, const Vector3d& command, const VectorXd& x,
                    std::array<Eigen::Vector2d, 5>* hits = nullptr,
                    std::array<int, 5>* faces = nullptr) const {
    const VectorXd s = x.tail(Index{kSharedCount});
    const rig::HeadPlace& head = machine_.head[static_cast<std::size_t>(axis)];
    const Vector3d square = s.segment<3>(kSquare), tilt = s.segment<3>(kTilt),
                   edges = s.segment<3>(kFaces);
    const Vector3d corner = head.position - machine_.TargetTravel(start);
    const Vector3d origin = head.position - machine_.HeadTravel(start);
    const Eigen::Matrix3d turn = head.rotation * Turn(s.segment<3>(kTurn + 3 * axis));
    const auto gaps = [&](const Vector3d& position, const Eigen::Matrix<double, 3, 6>& motions) {
      const Eigen::Isometry3d seen = Work(position, motions, square).inverse() *
                                     Body(machine_.tool_axes, position, motions, square);
      VectorXd gap(5);
      for (int probe = 0; probe < 5; ++probe) {
        const rig::ProbePlace& place = machine_.probes[static_cast<std::size_t>(probe)];
        const int direction = place.top ? 2 : 1;
        Vector3d in_head(place.along + s[kAlong + probe], 0.0, 0.0);
        in_head[direction] = place.range / 2 + s[kDepth + probe];
        in_head[3 - direction] = place.across + s[kAcross + probe];
        const Vector3d p =
            seen * (origin + head.rotation * Turn(s.segment<3>(kTurn + 3 * axis)) * in_head +
                    head.rotation * s.segment<3>(kPlace + 3 * axis));
        const Vector3d w = -(seen.rotation() * turn.col(direction));
        const Vector3d nominal = head.rotation.col(direction);
        Index normal_axis = 0;
        nominal.cwiseAbs().maxCoeff(&normal_axis);
        Eigen::Matrix3d of_face = Eigen::Matrix3d::Identity();
        if (normal_axis == 0) of_face = Turn({0.0, edges[1], edges[2]});
        if (normal_axis == 1) of_face = Turn({edges[0], 0.0, 0.0});
        const Vector3d m = Turn(tilt) * of_face * nominal;
        gap[probe] = (p - corner).dot(m) / -w.dot(m);
        if (hits == nullptr) continue;
        const Vector3d hit = p + gap[probe] * w - corner;
        const auto at = static_cast<std::size_t>(probe);
        (*hits)[at] = {hit[(normal_axis + 1) % 3], hit[(normal_axis + 2) % 3]};
        (*faces)[at] = 2 * static_cast<int>(normal_axis) + (nominal[normal_axis] > 0.0 ? 1 : 0);
      }
      return gap;
    };
    Eigen::Matrix<double, 3, 6> motions = Eigen::Matrix<double, 3, 6>::Zero();
    const VectorXd before = gaps(start, motions);
    motions.row(axis) = x.head<6>();
    VectorXd gap = gaps(command, motions);
    for (const bool top : {true, false}) {
      double mean = 0.0, count = 0.0;
      for (int probe = 0; probe < 5; ++probe) {
        if (machine_.probes[static_cast<std::size_t>(probe)].top != top) continue;
        mean += before[probe];
        count += 1.0;
      }
      for (int probe = 0; probe < 5; ++probe) {
        const rig::ProbePlace& place = machine_.probes[static_cast<std::size_t>(probe)];
        if (place.top != top) continue;
        // The fitter sets the mean gap of the unit.
        gap[probe] += place.range / 2 + s[kSet + 2 * axis + (top ? 0 : 1)] - mean / count;
        gap[probe] += s[kGain + probe] * (gap[probe] - place.range / 2);
      }
    }
    return gap;
  }

  void AddSweep(const recording::Recording& recording) {
    const int axis = recording.HeaderText("axis").value()[0] - 'X';
    const Vector3d start = machine_.StartOf(axis);
    const VectorXd sd = SharedDeviations();
    VectorXd steps(6 + Index{kSharedCount});
    steps.head<6>().setConstant(1e-6);
    steps.tail(Index{kSharedCount}) = sd.cwiseMax(1e-9);
    for (const Stay& stay : StaysOf(recording)) {
      std::array<Eigen::Vector2d, 5> hits;
      std::array<int, 5> faces{};
      Vector3d command = start;
      command[axis] = stay.position[axis];
      Readings(axis, start, command, VectorXd::Zero(steps.size()), &hits, &faces);
      const MatrixXd J = BySteps(
          steps, [&](const VectorXd& x) -> VectorXd { return Readings(axis, start, command, x); });
      for (int probe = 0; probe < 5; ++probe) {
        Datum datum{.kind = kSweep, .shared = {}, .linkage = {}};
        datum.at = command;
        datum.motions.row(axis) = J.row(probe).head<6>();
        datum.shared = sd.cwiseProduct(J.row(probe).tail(Index{kSharedCount}).transpose());
        datum.run = axis;
        datum.probe = probe;
        datum.face = faces[static_cast<std::size_t>(probe)];
        datum.hit = hits[static_cast<std::size_t>(probe)];
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
    constexpr int kCells = 200;  // of the slope of a straightness
    const auto [low, high] = machine_.travels[static_cast<std::size_t>(axis)];
    const double sd = Deviation(axis, motion), length = machine_.population.smoothness;
    // Positions that occur; most readings share theirs.
    std::vector<double> places{low};
    std::vector<Index> place_of;
    for (const Datum& datum : data_) {
      const double x = datum.at[axis];
      const auto found = std::find_if(places.begin(), places.end(),
                                      [&](double known) { return std::abs(known - x) < 1e-7; });
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

  MatrixXd Covariance() const {
    const auto n = static_cast<Index>(data_.size());
    MatrixXd K = MatrixXd::Zero(n, n);
    for (int axis = 0; axis < 3; ++axis) {
      for (int motion = 0; motion < 6; ++motion) {
        VectorXd by(n);
        for (Index i = 0; i < n; ++i)
          by[i] = data_[static_cast<std::size_t>(i)].motions(axis, motion);
        K += (by * by.transpose()).cwiseProduct(Functions(axis, motion));
      }
    }
    MatrixXd shared(n, Index{kSharedCount});
    for (Index i = 0; i < n; ++i) shared.row(i) = data_[static_cast<std::size_t>(i)].shared;
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
    if (a.face == b.face) {
      const double apart = (a.hit - b.hit).norm() / machine_.form_length;
      sum += std::pow(machine_.form, 2) * std::exp(-0.5 * apart * apart);
    }
    return sum;
  }

  const rig::RigSettings machine_;
  const rig::LinkageSettings linkage_settings_;
  const RigLinkageBound linkage_;
  std::vector<Datum> data_;
};

}  // namespace abbe::fusion
