// An arm of six joints before a tracker, made with rotation matrices of its own: what of it is not
// as the machine file says, and what is hidden, is known here alone.
//
// The seed picks the geometry, where the tracker stands (turned any way), the poses, the noise.
#pragma once

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>

#include "diagnosis/campaign.h"
#include "random/counter_random.h"
#include "settings/document.h"
#include "tests/relm/arm_rows.h"

namespace abbe {

// What is hidden in one joint (from 0); the angles are what the encoder shows beside the truth.
struct HiddenInArm {
  int joint = 0;
  double eccentricity_sin = 0.0, eccentricity_cos = 0.0;  // rad
  double gain = 0.0;
  // rad/m: what the joint gives over the lever of a weight at the end of its own link, where axes 5
  // and 6 meet, and in the ball.
  double own = 0.0, wrist = 0.0, load = 0.0;
  double slip = 0.0;                                       // rad, from the middle of the run on
  int far_off = 0;                                         // poses that the tracker saw elsewhere
  double far_by = 3e-3;                                    // m
  double drift_x = 0.0, drift_z = 0.0, drift_poses = 1.0;  // mm, first order, in the base frame
  double wave = 0.0, order = 0.0;  // rad, per turn: of the joint behind its encoder
  double behind = 0.0;             // rad: scatter of what the joints were read before they stood
};

class ArmWorld {
 public:
  static constexpr int kJoints = 6, kPoses = 160;

  static simulation::Instruments SetupOf(int joints = kJoints) {
    const std::span all(kRows);
    std::string text = "[linkage]\nball_mm = [40.0, 0.0, 0.0]\n" +
                       RowsText(all.first(static_cast<std::size_t>(joints))) + R"(
[linkage.base]
position_mm = [0.0, 0.0, 0.0]
[linkage.tolerance]
link_um = 1000
ball_um = 3000
pivot_urad = 2000
pivot_um = 500
encoder_offset_urad = 3000
eccentricity_urad = 20
compliance_urad = 20
[linkage.noise]
encoder_urad = 5.0
reference_um = 5.0
)";
    const auto document =
        settings::Document::Parse(fmt::format("name = \"arm\"\n{}", text), "arm.toml");
    return {machine::ReadMachineWithoutAxes(document.Root()),
            std::nullopt,
            {},
            {},
            relm::ReadLinkageSettings(document.Root())};
  }

  static recording::Recording Record(std::uint64_t seed, const HiddenInArm& hidden = {}) {
    const random::CounterRandom random(seed, 77);
    std::uint64_t draw = 0;
    const auto normal = [&](double sd) { return sd * random.Normal(draw++); };
    const auto within = [&](double most) { return random.Uniform(draw++, -most, most); };
    std::array<Row, kJoints> rows = kRows;
    for (Row& row : rows) {
      row.theta += normal(0.05);
      row.alpha += normal(0.03);
      row.d += normal(0.3);
      row.a += normal(0.3);
    }
    const Eigen::Vector3d ball(40.0 + normal(1.0), normal(1.0), normal(1.0));
    const Eigen::Matrix3d R_tracker =
        AboutZ(within(3.1)) * AboutX(within(1.5)) * AboutZ(within(3.1));
    const Eigen::Vector3d p_tracker(within(2000.0), within(2000.0), within(2000.0));
    recording::Recording recording;
    recording.name = fmt::format("arm {}", seed);
    recording.header = "kind = \"linkage\"\ntime = \"order\"\n";
    recording.columns.push_back({"time_s", {}});
    for (int i = 1; i <= kJoints; ++i)
      recording.columns.push_back({fmt::format("pivot_{}_rad", i), {}});
    for (int i = 1; hidden.behind > 0.0 && i <= kJoints; ++i)
      recording.columns.push_back({fmt::format("pivot_{}_commanded_rad", i), {}});
    for (const char* axis : {"x", "y", "z"}) {
      recording.columns.push_back({fmt::format("ref_{}_mm", axis), {}});
    }
    constexpr std::array<double, kJoints> kRange{2.5, 1.4, 1.4, 2.5, 1.8, 2.5};
    for (int pose = 0; pose < kPoses; ++pose) {
      std::array<double, kJoints> shown{}, turned{};
      for (std::size_t i = 0; i < shown.size(); ++i) {
        turned[i] = within(kRange[i]);
        shown[i] = turned[i] + normal(5e-6);
      }
      const auto joint = static_cast<std::size_t>(hidden.joint);
      const double q = turned[joint];
      shown[joint] += hidden.eccentricity_sin * std::sin(q) +
                      hidden.eccentricity_cos * std::cos(q) + hidden.gain * q +
                      (2 * pose >= kPoses ? hidden.slip : 0.0);
      const std::array<double, kJoints> sent = turned;
      shown[joint] += hidden.wave * std::sin(hidden.order * q);
      for (std::size_t i = 0; hidden.behind > 0.0 && i < shown.size(); ++i) {
        shown[i] += normal(hidden.behind);
      }
      turned[joint] += hidden.own * LeverOf(rows, sent, joint, {0, 0, 0}, joint + 1) +
                       hidden.wrist * LeverOf(rows, sent, joint, {0, 0, 0}, kJoints - 1) +
                       hidden.load * LeverOf(rows, sent, joint, ball, kJoints);
      const double warm = 1.0 - std::exp(-pose / hidden.drift_poses);
      const Eigen::Vector3d drift(hidden.drift_x * warm, 0.0, hidden.drift_z * warm);
      Eigen::Vector3d tip = R_tracker * (TipOf(rows, turned, ball) + drift) + p_tracker;
      for (int k = 0; k < 3; ++k) tip[k] += normal(5e-3);
      if (hidden.far_off > 0 && pose % (kPoses / hidden.far_off) == 7)
        tip[1] += 1e3 * hidden.far_by;
      auto column = recording.columns.begin();
      (column++)->values.push_back(pose);
      for (const double angle : shown) (column++)->values.push_back(angle);
      for (std::size_t i = 0; hidden.behind > 0.0 && i < sent.size(); ++i) {
        (column++)->values.push_back(sent[i]);
      }
      for (int k = 0; k < 3; ++k) (column++)->values.push_back(tip[k]);
    }
    return recording;
  }

 private:
  using Row = ArmRow;
  static constexpr std::array<Row, kJoints> kRows{{{0.0, 450.0, 150.0, -90.0},
                                                   {-90.0, 0.0, 600.0, 0.0},
                                                   {0.0, 0.0, 120.0, -90.0},
                                                   {0.0, 640.0, 0.0, 90.0},
                                                   {0.0, 0.0, 0.0, -90.0},
                                                   {0.0, 200.0, 0.0, 0.0}}};

  static Eigen::Matrix3d AboutZ(double angle) {
    Eigen::Matrix3d R;
    R << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
    return R;
  }
  static Eigen::Matrix3d AboutX(double angle) {
    Eigen::Matrix3d R;
    R << 1, 0, 0, 0, std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle);
    return R;
  }

  // mm, in the base frame, whose z is up; of the first `count` rows with a point of the last.
  static Eigen::Vector3d TipOf(const std::array<Row, kJoints>& rows,
                               const std::array<double, kJoints>& angles,
                               const Eigen::Vector3d& point, std::size_t count = kJoints) {
    constexpr double kDegree = 3.14159265358979323846 / 180.0;
    Eigen::Vector3d p = point;
    for (std::size_t i = count; i-- > 0;) {
      p = AboutX(kDegree * rows[i].alpha) * p + Eigen::Vector3d(rows[i].a, 0.0, rows[i].d);
      p = AboutZ(kDegree * rows[i].theta + angles[i]) * p;
    }
    return p;
  }

  // m: what the height of a point, fixed after the first `count` rows, loses by a turn of the joint.
  static double LeverOf(const std::array<Row, kJoints>& rows,
                        const std::array<double, kJoints>& angles, std::size_t joint,
                        const Eigen::Vector3d& point, std::size_t count) {
    constexpr double kStep = 1e-4;
    const auto height = [&](double turn) {
      std::array<double, kJoints> moved = angles;
      moved[joint] += turn;
      return 1e-3 * TipOf(rows, moved, point, count).z();
    };
    return (height(-kStep) - height(kStep)) / (2.0 * kStep);
  }
};

}  // namespace abbe
