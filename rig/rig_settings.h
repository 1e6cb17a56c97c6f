// The values of the machine file that the rig uses: the machine, its population of errors, the
// head, the target and the noise, read by the rig's own code, and its own table [rig].
//
// SI units. Frames: M, the machine; H, the head: u along the sweep, s along the outward normal of
// the target's side face, n along that of its top face.
//
// [rig] (all optional): acceleration_mm_s2 (200), lag_ms (15), update_hz (1000), target_tilt_urad
// (100), gap_setting_um (10), electrode_mm (0: no tilt response), temperature_c (20),
// temperature_drift_c (0.1), cap_um (1: lag of the ball in its cap at high feed), cap_feed_mm_min
// (10: the feed of half of that), cap_force_n (8.5: the force for which cap_um holds),
// encoder_counts (4194304 a turn). [rig.ageing]: the keys of [population] for what a day adds,
// [rig.ageing.by_kelvin] those for each kelvin; lag_s, swing_c, wander_c; all 0 unless stated.
// InputError with file, line and key; keys of shared tables that the rig does not use are not
// checked.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/sweep_plan.h"
#include "settings/document.h"

namespace abbe::rig {

inline constexpr int kAxes = 3;    // X, Y, Z
inline constexpr int kProbes = 5;  // a, b, c, d, e

struct AxisTravel {
  double first;
  double last;
};

// Standard deviations of the population; m, rad, relative.
struct ErrorPopulation {
  double positioning, straightness, roll, pitch, yaw, squareness, scale;
  double smoothness;  // m, correlation length
};

// How the machine changes over days: ageing.h. Without the table it does not.
struct AgeingSettings {
  ErrorPopulation walk;                         // after a day
  ErrorPopulation by_kelvin;                    // scale: growth; the others over the travel
  double lag = 0.0, swing = 0.0, wander = 0.0;  // s, K, K
};

struct ProbePlace {
  bool top;       // looks on the top face, else on the side face
  double along;   // u
  double across;  // s for a top probe, n for a side probe
  double range;   // largest gap
};

// A screw that the target rests on, or a fixed support (`pitch` 0): table [align.screw.NAME].
struct TargetScrew {
  std::string name;
  Eigen::Vector3d direction;  // in M: of the target there, turned clockwise
  Eigen::Vector3d place;      // from the corner of the target
  double pitch;               // a turn
};

// The pose of the head for the sweep of one axis.
struct HeadPlace {
  Eigen::Matrix3d rotation;  // columns u, s, n in M
  Eigen::Vector3d position;  // of the head's origin in M, at the start of the sweep
};

struct RigSettings {
  std::string name;
  std::string workpiece_axes;             // "XY" of [w X Y b Z t]: from the workpiece to the bed
  std::string tool_axes;                  // "Z": from the bed to the tool
  Eigen::Vector3d reference;              // in M: where the error motions act
  std::array<AxisTravel, kAxes> travels;  // as the controller counts
  // Direction of a carriage in M as the controller's position increases: +1 or -1, which is that of
  // an axis that carries the workpiece and is counted after ISO 841. The world uses the positions
  // of the carriages; programs, scales and recordings those of the controller.
  std::array<double, kAxes> sense = {1.0, 1.0, 1.0};
  ErrorPopulation population;

  std::array<ProbePlace, kProbes> probes;
  std::array<HeadPlace, kAxes> head;
  std::array<std::optional<hal::SweepPlan>, kAxes> sweeps;  // of [sweep]: those that it has
  double probe_position, installation_angle, installation_offset, gain;  // standard deviations
  double linearity = 0.0;  // m: standard deviation of what a probe departs from its straight line

  std::vector<TargetScrew> screws;
  double form, form_length;  // of the target's faces
  double target_squareness, u_target_squareness;
  double white, drift, drift_time;  // noise of one reading of one probe

  double acceleration, lag;               // of the motion
  double update_rate;                     // Hz
  double target_tilt;                     // uniform within +-
  double gap_setting;                     // standard deviation
  double electrode;                       // radius; 0: none
  double temperature, temperature_drift;  // degC; standard deviation of the slow drift

  double cap, cap_feed, cap_force;  // m, m/s, N
  double encoder_counts;            // a turn

  AgeingSettings ageing = {};

  bool CarriesTarget(int axis) const;
  // Direction of the tool in the workpiece as the controller's position increases: +1 or -1.
  double ToolWay(int axis) const { return CarriesTarget(axis) ? -sense[axis] : sense[axis]; }
  // The command at the start of the sweep of an axis: its first station, the other axes at the
  // first ends of their travels.
  Eigen::Vector3d StartOf(int axis) const;
  // The nominal displacement of the target, and of the head, in M at a command.
  Eigen::Vector3d TargetTravel(const Eigen::Vector3d& command) const;
  Eigen::Vector3d HeadTravel(const Eigen::Vector3d& command) const;

 private:
  Eigen::Vector3d MovedBy(const std::string& axes, const Eigen::Vector3d& command) const;
};

RigSettings ReadRigSettings(const settings::Table& root);

// "x", "-y": a direction of M; InputError that names the key of the table for any other text.
Eigen::Vector3d DirectionOf(const settings::Table& table, const char* key, const std::string& text);

// 0, 1, 2 of 'X', 'Y', 'Z'; InputError for any other letter.
int AxisNumber(char letter);

}  // namespace abbe::rig
