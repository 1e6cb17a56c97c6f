#include "rig/probe_runs.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "failure/failure.h"
#include "rig/hidden_run.h"
#include "rig/noise.h"
#include "rig/streams.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

using Eigen::Vector3d;

constexpr double kFromBelow = 0.5e-3;  // m, from below, of all axes

// The rows of one recording as they are made.
class ProbeRunMaker {
 public:
  ProbeRunMaker(const char* kind, const World& world, char axis, const LinkageRig* linkage,
                const ProbeRunOptions& options)
      : world_(world),
        axis_(AxisNumber(axis)),
        linkage_(linkage),
        options_(options),
        noise_(world.settings(), world.seed(), options.run),
        encoders_(world.seed(), kEncoderNoiseStream + kRunStreams * options.run,
                  linkage != nullptr ? linkage->linkage().settings().encoder_noise : 0.0),
        own_climate_(world.settings(), world.seed(), options.run, options.sensors),
        climate_(options.climate != nullptr ? *options.climate : own_climate_),
        hidden_(world.hidden(), climate_, {options.begin, axis_}) {
    std::vector<std::string> names{"time_s", "x_mm",      "y_mm",       "z_mm",
                                   "pass",   "direction", "feed_mm_min"};
    for (int i = 0; i < kProbes; ++i) names.push_back(fmt::format("probe_{:c}_um", 'a' + i));
    for (int i = 0; i < kPivots && linkage != nullptr; ++i) {
      names.push_back(fmt::format("pivot_{}_rad", i + 1));
    }
    names.insert(names.end(), options.sensors.begin(), options.sensors.end());
    names.emplace_back("flags");
    for (const std::string& name : names) made_.columns.push_back({name, {}});
    made_.header = fmt::format(
        "kind = \"{}\"\nmachine = {}\naxis = \"{:c}\"\nstarted = {}\nsource = \"rig\"\n{}\n"
        "[rig]\nseed = {}\nrun = {}\n{}",
        kind, settings::Quoted(world.settings().name), axis, options.started, options.keys,
        world.seed(), options.run, options.tables);
    made_.name = fmt::format("rig {} {:c}, seed {}", kind, axis, world.seed());
  }

  // To be called for every step, also between the rows.
  void Follow(const CourseState& state) {
    hidden_.Follow(state.time, state.position, state.velocity);
  }

  void Add(const CourseState& state) {
    column_ = 0;
    Put(state.time);
    for (const double each : state.position) Put(each / settings::kMillimetre);
    Put(state.pass);
    Put(state.direction);
    Put(state.feed / settings::UnitOf("feed_mm_min").si);
    const double flags = AddGaps(state.time);
    if (linkage_ != nullptr) AddAngles(state);
    for (const std::string& sensor : options_.sensors) {
      Put(climate_.At(sensor, options_.begin + state.time));
    }
    Put(flags);
  }

  recording::Recording Take() { return std::move(made_); }

 private:
  void Put(double value) { made_.columns[column_++].values.push_back(value); }

  double AddGaps(double time) {
    const RigSettings& machine = world_.settings();
    Readings gaps = world_.ReadingsAt(axis_, hidden_.PlaceFor(Source::kGaps));
    const auto tick = static_cast<std::uint64_t>(std::llround(time * machine.update_rate));
    for (int i = 0; i < kProbes; ++i) gaps[i] += noise_.OfProbe(i, tick, time);
    hidden_.Say(gaps);
    double flags = 0.0;
    for (int i = 0; i < kProbes; ++i) {
      const bool good = gaps[i] >= 0.0 && gaps[i] <= machine.probes[i].range;
      if (!good) flags = recording::kOutOfRange;
      Put(good ? gaps[i] / settings::kMicrometre : std::numeric_limits<double>::quiet_NaN());
    }
    return flags;
  }

  void AddAngles(const CourseState& state) {
    const RigSettings& machine = world_.settings();
    const double count = 2.0 * std::numbers::pi / machine.encoder_counts;
    const double temperature =
        climate_.At(linkage_->linkage().settings().temperature, options_.begin + state.time);
    Vector3d angles = linkage_->EncodersAt(state, temperature, machine.cap_force, hidden_,
                                           linkage_->SeatIn(options_.run)) +
                      encoders_.At(made_.columns.front().values.size());
    hidden_.Say(angles);
    for (const double angle : angles) Put(count * std::round(angle / count));
  }

  const World& world_;
  const int axis_;
  const LinkageRig* linkage_;
  const ProbeRunOptions options_;
  SensorNoise noise_;
  WhiteNoise encoders_;
  Climate own_climate_;
  Climate& climate_;
  HiddenRun hidden_;
  recording::Recording made_;
  std::size_t column_ = 0;
};

const hal::SweepPlan& PlanOf(const RigSettings& settings, char axis) {
  const auto& plan = settings.sweeps[AxisNumber(axis)];
  if (plan) return *plan;
  throw InputError(fmt::format(
      "no sweep of {:c} is programmed; add a table [sweep.{:c}] to the machine file", axis, axis));
}

}  // namespace

Course GapStepCourse(const RigSettings& settings, char axis, const ProbeRunOptions& options) {
  const hal::SweepPlan& plan = PlanOf(settings, axis);
  const int swept = AxisNumber(axis);
  const auto last = plan.stations.size() - 1;
  Course course{settings.StartOf(swept) - Vector3d::Constant(kFromBelow), {}};
  for (int place = 0; place < options.places; ++place) {
    Vector3d point = settings.StartOf(swept);
    point[swept] = plan.stations[last * place / std::max(1, options.places - 1)];
    course.moves.push_back({{point}, plan.feed});
    for (int other = 1; other < kAxes; ++other) {
      const int stepping = (swept + other) % kAxes;
      int before = 0;
      for (const int step : {0, 1, 0, -1, 0}) {
        Vector3d to = point;
        to[stepping] += step * kGapStep;
        const int direction = step > before ? 1 : step < before ? -1 : 1;
        course.moves.push_back({{to}, plan.feed, options.stand, place + 1, direction});
        before = step;
      }
    }
  }
  return course;
}

recording::Recording RecordGapSteps(const World& world, char axis, const ProbeRunOptions& options) {
  const RigSettings& machine = world.settings();
  const Course course = GapStepCourse(machine, axis, options);
  const double step = 1.0 / options.rate;
  ProbeRunMaker maker("gap-steps", world, axis, nullptr, options);
  CourseRun run(course, {machine.acceleration, machine.lag}, step);
  while (run.Next()) {
    maker.Follow(run.state());
    if (run.state().counts) maker.Add(run.state());
  }
  return maker.Take();
}

recording::Recording RecordDwell(const World& world, char axis, const LinkageRig* linkage,
                                 const ProbeRunOptions& options) {
  PlanOf(world.settings(), axis);
  ProbeRunMaker maker("dwell", world, axis, linkage, options);
  CourseState state;
  state.command = state.position = world.settings().StartOf(AxisNumber(axis));
  state.pass = 1;
  const int rows = static_cast<int>(options.length / kDwellInterval) + 1;
  for (int row = 0; row < rows; ++row) {
    state.time = row * kDwellInterval;
    maker.Follow(state);
    maker.Add(state);
  }
  return maker.Take();
}

}  // namespace abbe::rig
