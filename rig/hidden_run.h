// The hidden effects in one recording: follows the machine through it, and gives its true position
// and the effects on the readings.
//
//   HiddenRun hidden(effects, climate, {.begin = 0.0, .swept = 0});
//   hidden.Follow(time, position, velocity);              // at every step, in the order of time
//   gaps = world.ReadingsAt(0, hidden.PlaceFor(Source::kGaps));
//   for (double& gap : gaps) gap += noise();
//   hidden.Say(gaps);                                     // for each row
//
// The steps must be short against a reversal of the axes (the rig's are 1 to 50 ms; every reversal
// is a standstill of 0.1 s or the smooth top of a circle). Without effects every value passes
// unchanged, to the last bit. The machine was switched on `begin` seconds before the recording
// begins: warm-up, instants and the changes of temperatures count from there. m, s, rad.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "rig/climate.h"
#include "rig/hidden_effect.h"
#include "rig/machine_state.h"
#include "rig/probe_head.h"
#include "rig/run_parts.h"

namespace abbe::rig {

enum class Source : std::uint8_t { kGaps, kAngles };

class HiddenRun {
 public:
  struct About {
    double begin = 0.0;
    int swept = -1;  // the axis for whose sweep the head is installed
  };
  // `climate` must outlive it.
  HiddenRun(const HiddenEffects& effects, Climate& climate, const About& about);

  // The axis that is swept from now on.
  void Sweep(int axis) { state_.swept = axis; }

  // Time since the start of the recording; the axes as the controller shows them.
  void Follow(double time, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity);

  bool empty() const { return empty_; }
  // The true position of the carriages.
  const Eigen::Vector3d& Place() const { return place_; }
  // Their true position when `source` took the reading that has the present time as its stamp.
  Eigen::Vector3d PlaceFor(Source source) const;
  // The same minus the position by the controller.
  Eigen::Vector3d OffsetFor(Source source) const { return PlaceFor(source) - state_.position; }
  // Applies the effects to gaps with noise, before they are written.
  void Say(Readings& gaps);

  // The displacement of the ball in its cap, for a cap at this position.
  Eigen::Vector3d BallFrom(const Eigen::Vector3d& cap);
  bool drags_ball() const { return !parts_.balls.empty(); }
  // The additions to the angles of the encoders, for these true angles of the pivots.
  Eigen::Vector3d EncodersShow(const Eigen::Vector3d& turns);
  // Whether EncodersShow must be called now, also between the rows: 20 times a second where an
  // encoder has hysteresis.
  bool WantsTurns();
  // Applies the data effects to angles with noise, before they are written.
  void Say(Eigen::Vector3d& angles);

 private:
  void Turn(int axis, double position);

  Climate& climate_;
  const double begin_;
  const bool empty_;
  MachineState state_;
  bool begun_ = false;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d farthest_ = Eigen::Vector3d::Zero();  // of each axis along its direction
  std::map<std::string, double> at_start_;              // degC, of the effects' sensors
  RunParts parts_;
  bool remembers_turns_ = false;
  double next_turns_ = 0.0;  // s
};

}  // namespace abbe::rig
