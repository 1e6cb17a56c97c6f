// What a standard campaign of the virtual rig can show of an effect at all, and whether another
// cause could do the same: worked out from the recordings with and without the effect and the
// covariance of readings (study/bound/rig_map_bound.h), by no code of the diagnosis.
//
//   const VisibleEffects visible(worlds);
//   const Eigen::VectorXd column = visible.ColumnOf({"backlash:object=X"}, seed);
//   column.norm();                              // standard deviations, after projection
//   visible.BesideRivals(column, "backlash:X"); // what the best rival leaves of them
//
// The machine and the instruments are unknown within what the rig draws from: what they could do
// instead is in the covariance. A rival is another cause or another object, of any size; of causes
// with a shape a few shapes. The rows of the dwell are weighed by themselves, each channel with an
// unknown mean. Units: standard deviations.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "study/bound/rig_map_bound.h"
#include "study/hidden/hidden_world.h"
#include "study/hidden/judgement.h"

namespace abbe::study {

class VisibleEffects {
 public:
  using MatrixXd = Eigen::MatrixXd;
  using VectorXd = Eigen::VectorXd;

  explicit VisibleEffects(const HiddenWorlds& worlds)
      : worlds_(worlds.WithoutCounts()),
        slopes_(worlds.machine().rig),
        linkage_(*worlds.machine().linkage),
        base_(*worlds.machine().linkage) {
    RigMapBound readings(worlds.machine().rig, base_, Eigen::Matrix3Xd(3, 0));
    const rig::Campaign clean = worlds.Record(kSeed, {});
    for (const auto& recording : clean.recordings) {
      if (recording.Kind() == "dwell") {
        dwell_.compute(CovarianceOfDwell(recording));
      } else {
        readings.Add(recording);
      }
    }
    const MatrixXd K = readings.Covariance();
    scale_ = K.diagonal().cwiseSqrt().cwiseInverse();
    factor_.compute(scale_.asDiagonal() * K * scale_.asDiagonal());
    for (const std::string& effect : Rivals()) {
      rivals_[NameOf(rig::ParseHidden(effect, kSeed, worlds.machine().sensors))].push_back(
          ColumnOf({effect}, kSeed));
    }
  }

  // By how many standard deviations each reading changes, free of what all others tell.
  VectorXd ColumnOf(const std::vector<std::string>& hidden, std::uint64_t seed) const {
    return ColumnOfWorld(worlds_.Record(seed, hidden), seed);
  }
  // The same of a world; its encoders count in steps.
  VectorXd ColumnOfWorld(const rig::Campaign& with, std::uint64_t seed) const {
    const rig::Campaign without = worlds_.Record(seed, {});
    std::vector<double> campaign, dwell;
    for (std::size_t i = 0; i < with.recordings.size(); ++i) {
      const bool still = with.recordings[i].Kind() == "dwell";
      Append(Readings(with.recordings[i]) - Readings(without.recordings[i]),
             still ? dwell : campaign);
    }
    VectorXd column(static_cast<Eigen::Index>(campaign.size() + dwell.size()));
    column << factor_.matrixL().solve(VectorXd(scale_.cwiseProduct(Mapped(campaign)))),
        WhiteDwell(Mapped(dwell));
    return column;
  }

  // What is left of a column when the best of all other causes does what it can.
  double BesideRivals(const VectorXd& column, const std::string& name) const {
    double least = column.norm();
    for (const auto& [rival, columns] : rivals_) {
      if (rival == name) continue;
      MatrixXd R(column.size(), static_cast<Eigen::Index>(columns.size()));
      for (std::size_t i = 0; i < columns.size(); ++i)
        R.col(static_cast<Eigen::Index>(i)) = columns[i];
      const VectorXd explained = R * R.colPivHouseholderQr().solve(column);
      least = std::min(least, (column - explained).norm());
    }
    return least;
  }

 private:
  static constexpr std::uint64_t kSeed = 77;  // of the machine on which the rivals are tried

  static void Append(const VectorXd& values, std::vector<double>& all) {
    all.insert(all.end(), values.begin(), values.end());
  }
  static Eigen::Map<const VectorXd> Mapped(const std::vector<double>& values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
  }
  static std::string ProbeColumn(int probe) {
    return std::string("probe_") + static_cast<char>('a' + probe) + "_um";
  }

  // In the order of RigMapBound; of a dwell, channel by channel.
  VectorXd Readings(const recording::Recording& recording) const {
    std::vector<double> values;
    const std::string kind = recording.Kind();
    if (kind == "dwell") {
      for (int probe = 0; probe < rig::kProbes; ++probe) {
        for (const double gap : recording.At(ProbeColumn(probe))) values.push_back(1e-6 * gap);
      }
      for (const char* pivot : kPivots) {
        for (const double angle : recording.At(pivot)) values.push_back(angle);
      }
      return Mapped(values);
    }
    const auto stays = RigStaysOf(recording);
    const double start = kind == "length" ? stays.front().MeanOf(recording, "length_mm") : 0.0;
    for (std::size_t s = kind == "length" ? 1 : 0; s < stays.size(); ++s) {
      if (kind == "length")
        values.push_back(1e-3 * (stays[s].MeanOf(recording, "length_mm") - start));
      if (kind == "linkage") Append(BallOf(stays[s], recording), values);
      if (kind != "sweep") continue;
      for (int probe = 0; probe < rig::kProbes; ++probe) {
        values.push_back(1e-6 * stays[s].MeanOf(recording, ProbeColumn(probe)));
      }
    }
    return Mapped(values);
  }

  // Where the ball stands for the angles, to first order.
  VectorXd BallOf(const RigStay& stay, const recording::Recording& recording) const {
    const Eigen::Matrix3d& R = base_.base_rotation;
    const Eigen::Vector3d ball = slopes_.BallAt(stay.position) - base_.base_position;
    Eigen::Vector3d angles;
    for (int i = 0; i < 3; ++i) angles[i] = stay.MeanOf(recording, kPivots[i]);
    return R * linkage_.Slope(linkage_.Angles(R.transpose() * ball), 0.0) * angles;
  }

  // One probe: white noise, drift, and a mean that nobody knows.
  MatrixXd CovarianceOfDwell(const recording::Recording& recording) const {
    constexpr double kAnyMean = 1e3;  // times the noise
    const auto& rig = worlds_.machine().rig;
    const auto time = recording.At("time_s");
    const auto n = static_cast<Eigen::Index>(time.size());
    MatrixXd V(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        V(i, j) = rig.drift * rig.drift * std::exp(-std::abs(time[i] - time[j]) / rig.drift_time);
      }
    }
    V.array() += std::pow(kAnyMean * rig.white, 2);
    V.diagonal().array() += rig.white * rig.white;
    return V;
  }

  VectorXd WhiteDwell(const VectorXd& values) const {
    const Eigen::Index rows = dwell_.rows();
    VectorXd white = values;
    for (int probe = 0; probe < rig::kProbes; ++probe) {
      dwell_.matrixL().solveInPlace(white.segment(probe * rows, rows));
    }
    for (int pivot = 0; pivot < 3; ++pivot) {
      auto angles = white.segment((rig::kProbes + pivot) * rows, rows);
      angles.array() -= angles.mean();
      angles /= base_.encoder_noise;
    }
    return white;
  }

  // One effect for each coefficient of each cause at each object, a few for each shape.
  static std::vector<std::string> Rivals() {
    std::vector<std::string> effects;
    const auto add = [&](const std::string& cause, const std::vector<std::string>& objects,
                         const std::vector<std::string>& keys) {
      for (const std::string& object : objects) {
        for (const std::string& key : keys) effects.push_back(cause + ":object=" + object + key);
      }
    };
    const std::vector<std::string> axes{"X", "Y", "Z"}, pairs{"XY", "XZ", "YZ"},
        probes{"probe_a", "probe_b", "probe_c", "probe_d", "probe_e"},
        pivots{"pivot_1", "pivot_2", "pivot_3"};
    std::vector<std::string> couples;
    for (const std::string& one : probes) {
      for (const std::string& other : probes) {
        if (one != other) couples.push_back(one + "+" + other);
      }
    }
    const std::string nothing = ":sin2_um=0:cos2_um=0:sin3_um=0:cos3_um=0";
    add("backlash", axes, {":width_um=3"});
    add("leadscrew-cyclic", axes,
        {":pitch_mm=6:amplitude_um=1:phase_rad=0", ":pitch_mm=6:amplitude_um=1:phase_rad=1.5708"});
    add("scale-error", axes, {":gain_ppm=50"});
    add("squareness", pairs, {":angle_urad=50"});
    add("thermal-growth", axes, {":coefficient_ppm_per_c=10"});
    for (const char* time : {":time_constant_s=300", ":time_constant_s=1200"}) {
      add("warm-up-drift", axes, {std::string(":amplitude_um=3") + time});
      add("warm-up-drift", probes, {std::string(":amplitude_um=0.5") + time});
      add("warm-up-drift", pivots, {std::string(":amplitude_urad=30") + time});
    }
    add("servo-lag-mismatch", pairs, {":delay_ms=0.5"});
    add("servo-lag", axes, {":delay_ms=0.5"});
    add("reversal-spike", axes, {":height_um=3:decay_mm=0.5", ":height_um=3:decay_mm=2"});
    add("load-coupling", pairs, {":coefficient_nm_per_mm2=1"});
    add("probe-gain", probes, {":delta=0.01"});
    add("probe-nonlinearity", probes, {":quadratic_per_mm=0.5"});
    add("probe-position", probes, {":du_mm=0.1:dv_mm=0", ":du_mm=0:dv_mm=0.1"});
    add("probe-crosstalk", couples, {":coefficient=0.01"});
    add("encoder-eccentricity", pivots, {":sin_urad=50:cos_urad=0", ":sin_urad=0:cos_urad=50"});
    add("encoder-subdivision", pivots,
        {":order=8:sin_urad=10:cos_urad=0", ":order=8:sin_urad=0:cos_urad=10"});
    for (const char* wave : {"sin2_um=0", "cos2_um=0", "sin3_um=0", "cos3_um=0"}) {
      std::string keys = nothing;
      keys[keys.find(wave) + std::string(wave).size() - 1] = '3';
      add("bearing-roundness", pivots, {keys});
    }
    add("link-thermal-growth", {"link_1", "link_2"}, {":coefficient_ppm_per_c=10"});
    add("link-gravity-bend", {"pivot_2", "pivot_3"}, {":compliance_urad=50"});
    add("joint-hysteresis", pivots, {":width_urad=20"});
    add("cap-friction", {"cap"}, {":displacement_um=1"});
    add("clock-skew", {"linkage", "probes"}, {":delay_ms=1"});
    return effects;
  }

  static constexpr const char* kPivots[3] = {"pivot_1_rad", "pivot_2_rad", "pivot_3_rad"};

  const HiddenWorlds worlds_;
  const RigSlopes slopes_;
  const RigLinkageBound linkage_;
  const rig::LinkageSettings base_;
  VectorXd scale_;
  Eigen::LLT<MatrixXd> factor_, dwell_;
  std::map<std::string, std::vector<VectorXd>> rivals_;
};

}  // namespace abbe::study
