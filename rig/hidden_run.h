// What the hidden effects do to one recording: follows the machine through it and says where it
// really is and what the instruments say of that.
//
//   HiddenRun hidden(effects, climate, {.begin = 0.0, .swept = 0});
//   hidden.Follow(time, position, velocity);              // at every step, in the order of time
//   gaps = world.ReadingsAt(0, hidden.PlaceFor(Source::kGaps));
//   for (double& gap : gaps) gap += noise();
//   hidden.Say(gaps);                                     // for each row
//
// The steps are short against a turn of the axes (the rig's are 1 to 50 ms; every turn is a
// standstill of 0.1 s or the smooth top of a circle). Without effects every value passes unchanged,
// to the last bit. The machine was switched on `begin` seconds before the recording begins: warm-up
// and instants count from there, and temperatures from what they were then. m, s, rad.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "rig/climate.h"
#include "rig/hidden_channels.h"
#include "rig/hidden_effect.h"
#include "rig/hidden_motion.h"
#include "rig/machine_state.h"
#include "rig/probe_head.h"

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

  // Which axis is swept from now on.
  void Sweep(int axis) { state_.swept = axis; }

  // Time since the start of the recording; the axes as the controller shows them.
  void Follow(double time, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity);

  bool empty() const { return empty_; }
  // Where the carriages really are.
  const Eigen::Vector3d& Place() const { return place_; }
  // Where they were when this source looked that its stamp gives the present time.
  Eigen::Vector3d PlaceFor(Source source) const;
  // The same, from what the controller shows.
  Eigen::Vector3d OffsetFor(Source source) const { return PlaceFor(source) - state_.position; }
  // What the gaps, noise and all, become before they are written.
  void Say(Readings& gaps);

  // Where the ball stands from where the cap holds it, for a cap at this place.
  Eigen::Vector3d BallFrom(const Eigen::Vector3d& cap);
  bool drags_ball() const { return !balls_.empty(); }
  // What the encoders show beside what they should.
  Eigen::Vector3d EncodersShow(const Eigen::Vector3d& turns);
  // Whether it must be asked now although nobody reads: 20 times a second where an encoder shows
  // how its pivot came there.
  bool WantsTurns();
  // What the angles, noise and all, become before they are written.
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
  std::array<double, 2> late_{};                        // s, of each source
  std::map<std::string, double> at_start_;              // degC, of the effects' sensors
  std::vector<AxisShift> shifts_;
  std::vector<ProbeAddition> probes_;
  std::vector<PivotAddition> pivots_;
  std::vector<DataEffect> data_;
  std::vector<DraggedBall> balls_;
  std::vector<std::array<std::size_t, 2>> swapped_;  // probes
  bool remembers_turns_ = false;
  double next_turns_ = 0.0;  // s
};

}  // namespace abbe::rig
