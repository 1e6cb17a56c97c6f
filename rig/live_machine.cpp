#include "rig/live_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "failure/failure.h"
#include "rig/rig_channel.h"
#include "rig/streams.h"

namespace abbe::rig {
namespace {

using Eigen::Vector3d;

constexpr double kRapid = 0.05;  // m/s, to a course and back

Vector3d RestOf(const RigSettings& settings) {
  return {settings.travels[0].first, settings.travels[1].first, settings.travels[2].first};
}

CourseState StandingAt(const Vector3d& place) {
  CourseState state;
  state.command = state.position = place;
  return state;
}

Course FromRestAndBack(Course course, const Vector3d& rest) {
  course.moves.insert(course.moves.begin(), {{course.start}, kRapid});
  course.moves.push_back({{rest}, kRapid});
  course.start = rest;
  return course;
}

// Checks points 0.5 mm or more apart, and the last of each move.
void RequireReach(const LinkageRig& linkage, const Course& course) {
  constexpr double kBetweenChecks = 0.5e-3;
  const double temperature = linkage.world().settings().temperature;
  Vector3d checked = Vector3d::Constant(1e9);
  for (const Move& move : course.moves) {
    for (const Vector3d& point : move.points) {
      if ((point - checked).norm() < kBetweenChecks && &point != &move.points.back()) continue;
      linkage.linkage().EncodersFor(linkage.ToolAt(point), temperature);
      checked = point;
    }
  }
}

std::vector<std::string> LinkSensor(const LinkageRig* linkage) {
  if (linkage == nullptr) return {};
  return {linkage->linkage().settings().temperature};
}

}  // namespace

std::function<double()> SimulatedTime(double speed) {
  const auto start = std::chrono::steady_clock::now();
  return [start, speed] {
    return speed * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
}

LiveMachine::LiveMachine(const World& world, std::function<double()> time,
                         const LinkageRig* linkage, std::optional<Course> course, double cap_force)
    : world_(world),
      time_(std::move(time)),
      linkage_(linkage),
      cap_force_(cap_force > 0.0 ? cap_force : world.settings().cap_force),
      noise_(world.settings(), world.seed(), 0),
      climate_(world.settings(), world.seed(), 0, LinkSensor(linkage)),
      hidden_(world.hidden(), climate_, {.swept = 0}),
      encoder_noise_(world.seed(), kEncoderNoiseStream,
                     linkage != nullptr ? linkage->linkage().settings().encoder_noise : 0.0),
      ball_(world.seed(), kBallStream,
            linkage != nullptr ? linkage->linkage().settings().repeatability : 0.0),
      screws_(world.settings(), world.CornerOf(0)) {
  latest_.axes = StandingAt(RestOf(world.settings()));
  hidden_.Follow(0.0, latest_.axes.position, Vector3d::Zero());
  if (!course) return;
  if (linkage_ != nullptr) RequireReach(*linkage_, *course);
  course_ = FromRestAndBack(std::move(*course), latest_.axes.position);
}

StartOutcome LiveMachine::Start(int program) {
  const RigSettings& settings = world_.settings();
  const std::lock_guard lock(mutex_);
  if (Latest().state == ProgramState::kRunning) return StartOutcome::kBusy;
  const Dynamics dynamics{settings.acceleration, settings.lag};
  motion_.reset();
  run_.reset();
  jog_.reset();
  if (program == kCourseProgram && course_) {
    run_.emplace(*course_, CourseRun::Dynamics{dynamics.acceleration, dynamics.lag},
                 1.0 / settings.update_rate);
    run_ticks_ = 0;
  } else if (program >= 0 && program < kAxes && settings.sweeps[program]) {
    motion_.emplace(*settings.sweeps[program], dynamics, settings.travels[program].first);
    head_axis_ = program;
    screws_.MountAt(world_.CornerOf(program));
    hidden_.Sweep(program);
  } else {
    return StartOutcome::kNoSuchProgram;
  }
  latest_.axes = StandingAt(RestOf(settings));
  latest_.program = program;
  latest_.state = ProgramState::kRunning;
  started_ = latest_.tick;
  gaps_tick_.reset();
  return StartOutcome::kStarted;
}

const Moment& LiveMachine::LatestByHand() {
  if (Latest().state == ProgramState::kRunning) {
    throw InputError("a program runs; wait until it is done");
  }
  gaps_tick_.reset();
  return latest_;
}

void LiveMachine::Jog(int axis, double position) {
  const std::lock_guard lock(mutex_);
  const auto& [first, last] = world_.settings().travels[axis];
  if (position < first || position > last) {
    throw InputError(fmt::format("{:.6g} mm is beyond the travel of {:c}, {:.6g} to {:.6g} mm",
                                 1e3 * position, 'X' + axis, 1e3 * first, 1e3 * last));
  }
  const Moment& now = LatestByHand();
  jog_ = {axis, now.axes.position[axis], position, now.axes.time};
}

void LiveMachine::Turn(std::string_view screw, double turns) {
  const std::lock_guard lock(mutex_);
  LatestByHand();
  screws_.Turn(screw, turns);
}

void LiveMachine::InstallHead(int axis) {
  const std::lock_guard lock(mutex_);
  LatestByHand();
  head_axis_ = axis;
  hidden_.Sweep(axis);
  screws_.MountAt(world_.CornerOf(axis));
}

void LiveMachine::JogOn(double time) {
  if (!jog_) return;
  const double way = std::min(std::abs(jog_->to - jog_->from), kRapid * (time - jog_->start));
  latest_.axes.position[jog_->axis] = jog_->from + std::copysign(way, jog_->to - jog_->from);
  latest_.axes.command = latest_.axes.position;
}

Moment LiveMachine::Now() {
  const std::lock_guard lock(mutex_);
  return Latest();
}

const Moment& LiveMachine::Latest() {
  const double ticks = std::max(0.0, time_()) * world_.settings().update_rate;
  const auto tick = static_cast<std::uint64_t>(ticks);
  if (tick > latest_.tick) {
    latest_.tick = tick;
    const double time = tick / world_.settings().update_rate;
    if (latest_.state == ProgramState::kRunning) {
      Advance(latest_);
    } else {
      JogOn(time);
      hidden_.Follow(time, latest_.axes.position, Vector3d::Zero());
    }
    latest_.axes.time = time;
    followed_ = tick;
  }
  return latest_;
}

// Passes the updates between two requests on to the hidden effects, 200 a second.
void LiveMachine::FollowSweep(std::uint64_t to) {
  const RigSettings& settings = world_.settings();
  const auto stride = static_cast<std::uint64_t>(std::max(1.0, settings.update_rate / 200.0));
  Vector3d axes = latest_.axes.position;
  for (; followed_ + stride < to; followed_ += stride) {
    const double time = (followed_ + stride) / settings.update_rate;
    const MotionState state = motion_->At(time - started_ / settings.update_rate);
    axes[latest_.program] = state.position;
    const double speed = (state.command - state.position) / settings.lag;
    hidden_.Follow(time, axes, speed * Vector3d::Unit(latest_.program));
  }
}

void LiveMachine::Advance(Moment& moment) {
  const std::uint64_t since = moment.tick - started_;
  const double rate = world_.settings().update_rate;
  Vector3d velocity = Vector3d::Zero();
  bool done = false;
  if (run_) {
    for (; run_ticks_ < since && !done; ++run_ticks_) {
      done = !run_->Next();
      if (hidden_.empty()) continue;
      const CourseState& state = run_->state();
      const double time = (started_ + run_ticks_) / rate;
      hidden_.Follow(time, state.position, state.velocity);
      if (linkage_ != nullptr) {
        linkage_->Follow(state, climate_.At(LinkSensor(linkage_).front(), time), cap_force_,
                         hidden_);
      }
    }
    moment.axes = run_->state();
    velocity = moment.axes.velocity;
  } else {
    if (!hidden_.empty()) FollowSweep(moment.tick);
    const RigSettings& settings = world_.settings();
    const MotionState state = motion_->At(since / settings.update_rate);
    moment.axes.position[moment.program] = state.position;
    moment.axes.command[moment.program] = state.command;
    velocity = (state.command - state.position) / settings.lag * Vector3d::Unit(moment.program);
    moment.axes.pass = state.pass;
    moment.axes.direction = state.direction;
    moment.axes.feed = settings.sweeps[moment.program]->feed;
    moment.axes.counts = state.pass > 0;
    done = state.done;
  }
  hidden_.Follow(moment.tick / rate, moment.axes.position, velocity);
  if (!done) return;
  moment.state = ProgramState::kDone;
  moment.axes = StandingAt(RestOf(world_.settings()));
}

std::optional<double> LiveMachine::ReadingOf(std::string_view channel, const Moment& moment) {
  using Quantity = RigChannel::Quantity;
  const std::optional<RigChannel> parsed = ParseChannel(channel);
  if (!parsed) return std::nullopt;
  const CourseState& axes = moment.axes;
  const std::lock_guard lock(mutex_);
  switch (parsed->quantity) {
    case Quantity::kPosition:
      return axes.position[parsed->index] / parsed->unit;
    case Quantity::kPass:
      return axes.counts ? axes.pass : 0;
    case Quantity::kDirection:
      return axes.counts ? axes.direction : 0;
    case Quantity::kFeed:
      return axes.counts ? axes.feed / parsed->unit : 0.0;
    case Quantity::kTemperature:
      return climate_.At(channel, axes.time);
    case Quantity::kGap:
      break;
  }
  const double gap = GapsAt(moment)[parsed->index];
  if (gap < 0.0 || gap > world_.settings().probes[parsed->index].range) return std::nullopt;
  return gap / parsed->unit;
}

const Readings& LiveMachine::GapsAt(const Moment& moment) {
  if (gaps_tick_ == moment.tick) return gaps_;
  gaps_ = world_.ReadingsAt(head_axis_, moment.axes.position + hidden_.OffsetFor(Source::kGaps),
                            screws_.Seat());
  for (int probe = 0; probe < kProbes; ++probe) {
    gaps_[probe] += noise_.OfProbe(probe, moment.tick, moment.axes.time);
  }
  hidden_.Say(gaps_);
  gaps_tick_ = moment.tick;
  return gaps_;
}

std::optional<Vector3d> LiveMachine::EncodersNow() {
  if (linkage_ == nullptr) return std::nullopt;
  const std::lock_guard lock(mutex_);
  const Moment& now = Latest();
  const double temperature = climate_.At(LinkSensor(linkage_).front(), now.axes.time);
  try {
    Vector3d angles = linkage_->EncodersAt(now.axes, temperature, cap_force_, hidden_,
                                           ball_.At(now.axes.position)) +
                      encoder_noise_.At(now.tick);
    hidden_.Say(angles);
    return angles;
  } catch (const Failure&) {
    return std::nullopt;  // out of reach
  }
}

}  // namespace abbe::rig
