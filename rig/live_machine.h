// The rig's machine in simulated time: at rest, or running a program. Programs 0,
// 1, 2 are the sweeps of X, Y, Z, program 3 is the course that it was given.
//
//   const Course circle = CircleCourse({.radius = 0.01, .feed = 1e-3});
//   LiveMachine machine(world, SimulatedTime(20.0), &linkage, circle);
//   machine.Start(kCourseProgram);
//   const Moment now = machine.Now();
//   machine.ReadingOf("x_mm", now);  machine.EncodersNow();
//
// Axes and sensors take a new state `update_rate` times a second; between two updates they show the
// same one. Every program begins and ends at rest, the first ends of the travels; the moves from
// there to a course and back do not belong to it (pass 0). The head is installed as for the sweep
// that was started last (X before the first). Time is simulated time since the rig was switched on,
// s; hidden effects act as in a recording that began then. Safe for several threads; a time before
// the latest moment is taken as that.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rig/climate.h"
#include "rig/course.h"
#include "rig/hidden_run.h"
#include "rig/motion.h"
#include "rig/noise.h"
#include "rig/record_course.h"
#include "rig/target_screws.h"
#include "rig/world.h"

namespace abbe::rig {

enum class ProgramState : std::uint16_t { kIdle = 0, kRunning = 1, kDone = 2 };
enum class StartOutcome { kStarted, kBusy, kNoSuchProgram };

inline constexpr int kCourseProgram = kAxes;

// The machine at one update.
struct Moment {
  std::uint64_t tick = 0;
  int program = 0;  // started last
  ProgramState state = ProgramState::kIdle;
  CourseState axes;  // its time is that of the update
};

// Simulated seconds since the call, `speed` of them in a second of real time.
std::function<double()> SimulatedTime(double speed);

class LiveMachine {
 public:
  // `world` and `linkage` must outlive the machine. `cap_force` as in CourseOptions. InputError
  // when a position of the course is out of the linkage's reach.
  LiveMachine(const World& world, std::function<double()> time, const LinkageRig* linkage = nullptr,
              std::optional<Course> course = {}, double cap_force = 0.0);

  StartOutcome Start(int program);
  // By hand, while no program runs: moves an axis to a position of the control, 50 mm/s; turns a
  // screw of the target, clockwise; installs the head as for the sweep of `axis`. InputError for a
  // position beyond the travel, a screw that there is not, or while a program runs.
  void Jog(int axis, double position);
  void Turn(std::string_view screw, double turns);
  void InstallHead(int axis);
  Moment Now();

  // The reading of a channel (rig_channel.h), in the unit of its name. Empty: the gap is out of the
  // probe's range, 0 to `range`, or the rig has no such channel.
  std::optional<double> ReadingOf(std::string_view channel, const Moment& moment);

  bool has_linkage() const { return linkage_ != nullptr; }
  bool has_course() const { return course_.has_value(); }
  // The angles of the linkage's encoders, rad, with noise. Empty: the ball is out of reach.
  std::optional<Eigen::Vector3d> EncodersNow();

 private:
  const Moment& Latest();        // moves on to it
  const Moment& LatestByHand();  // InputError while a program runs
  void JogOn(double time);
  void Advance(Moment& moment);
  void FollowSweep(std::uint64_t to);
  const Readings& GapsAt(const Moment& moment);

  const World& world_;
  const std::function<double()> time_;
  const LinkageRig* linkage_;
  std::optional<Course> course_;
  const double cap_force_;
  std::mutex mutex_;
  SensorNoise noise_;
  Climate climate_;  // the linkage's sensor, then the others in the order of first reading
  HiddenRun hidden_;
  std::uint64_t followed_ = 0;  // tick
  WhiteNoise encoder_noise_;
  BallSeat ball_;
  int head_axis_ = 0;
  Moment latest_;
  std::uint64_t started_ = 0;  // tick
  struct JogMotion {
    int axis;
    double from, to, start;  // s
  };
  std::optional<JogMotion> jog_;
  TargetScrews screws_;
  std::optional<SweepMotion> motion_;
  std::optional<CourseRun> run_;
  std::uint64_t run_ticks_ = 0;
  std::optional<std::uint64_t> gaps_tick_;
  Readings gaps_{};
};

}  // namespace abbe::rig
