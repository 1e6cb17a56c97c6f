#include "rig/record_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/sweep_recorder.h"
#include "rig/course.h"
#include "rig/hidden_run.h"
#include "rig/motion.h"
#include "rig/noise.h"
#include "rig/rig_channel.h"

namespace abbe::rig {
namespace {

constexpr double kStill = 1e-9;  // m; see the header

class SweepMaker {
 public:
  SweepMaker(const World& world, int axis, const std::vector<hal::Channel>& channels,
             const RecordSweepOptions& options)
      : world_(world),
        axis_(axis),
        plan_(Planned(*world.settings().sweeps[axis], options)),
        options_(options),
        motion_(plan_, {world.settings().acceleration, world.settings().lag},
                world.settings().travels[axis].first),
        noise_(world.settings(), world.seed(), options.run),
        own_climate_(world.settings(), world.seed(), options.run, Sensors(channels)),
        climate_(options.climate != nullptr ? *options.climate : own_climate_),
        hidden_(world.hidden(), climate_, {options.begin, axis}),
        axes_(world.settings().StartOf(axis)) {
    for (const std::string& name : hal::SweepColumns(channels))
      sweep_.columns.push_back({name, {}});
    for (std::size_t column = kFirstReading; column + 1 < sweep_.columns.size(); ++column) {
      const auto channel = ParseChannel(sweep_.columns[column].name);
      if (!channel) {
        throw InputError(
            fmt::format("the rig has no channel \"{}\"; record x_mm, y_mm, z_mm, "
                        "probe_a_um to probe_e_um and temp_NAME_c only",
                        sweep_.columns[column].name));
      }
      channels_.push_back(*channel);
    }
    const hal::SweepAbout about{
        world.settings().name, options.started, "rig", options.mounting,
        fmt::format("{}[rig]\nseed = {}\nrun = {}\n", options.more, world.seed(), options.run)};
    sweep_.header = hal::SweepHeader(plan_, about, channels);
    sweep_.name = fmt::format("rig sweep {:c}, seed {}", plan_.axis, world.seed());
  }

  recording::Recording Make() {
    RefuseTooLong(motion_.duration(), options_.rate);
    const auto count = static_cast<std::size_t>(motion_.duration() * options_.rate) + 1;
    if (options_.moving) {
      for (recording::Column& column : sweep_.columns) column.values.reserve(count);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double time = i / options_.rate;
      const MotionState state = motion_.At(time);
      axes_[axis_] = state.position;
      const double speed = (state.command - state.position) / world_.settings().lag;
      hidden_.Follow(time, axes_, speed * Eigen::Vector3d::Unit(axis_));
      if (state.pass == 0 || (state.station < 0 && !options_.moving)) continue;
      Add(time, state);
    }
    return std::move(sweep_);
  }

 private:
  static constexpr std::size_t kPosition = 1, kPass = 4, kDirection = 5, kFeed = 6,
                               kFirstReading = 7;

  static hal::SweepPlan Planned(hal::SweepPlan plan, const RecordSweepOptions& options) {
    if (options.passes > 0) plan.passes = options.passes;
    return plan;
  }

  void Put(std::size_t column, double value) { sweep_.columns[column].values.push_back(value); }

  static std::vector<std::string> Sensors(const std::vector<hal::Channel>& channels) {
    std::vector<std::string> sensors;
    for (const hal::Channel& channel : channels) {
      if (channel.name.starts_with("temp_")) sensors.push_back(channel.name);
    }
    return sensors;
  }

  void Add(double time, const MotionState& state) {
    Put(0, time);
    for (int axis = 0; axis < kAxes; ++axis) {
      Put(kPosition + axis, axes_[axis] / settings::kMillimetre);
    }
    Put(kPass, state.pass);
    Put(kDirection, state.direction);
    Put(kFeed, plan_.feed / settings::UnitOf("feed_mm_min").si);
    const Readings gaps = Gaps(time);
    std::uint32_t flags = 0;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const std::size_t column = kFirstReading + i;
      Put(column, channels_[i].quantity == RigChannel::Quantity::kTemperature
                      ? climate_.At(sweep_.columns[column].name, options_.begin + time)
                      : Gap(channels_[i], gaps, flags));
    }
    Put(sweep_.columns.size() - 1, flags);
  }

  // The gaps as recorded, with noise and hidden effects.
  Readings Gaps(double time) {
    const Eigen::Vector3d place = hidden_.PlaceFor(Source::kGaps);
    Eigen::Vector3d moved = place - gaps_at_;
    moved[axis_] = std::max(0.0, std::abs(moved[axis_]) - kStill);
    if (!(moved.squaredNorm() == 0.0)) {
      gaps_at_ = place;
      gaps_ = world_.ReadingsAt(axis_, place);
    }
    const auto tick =
        static_cast<std::uint64_t>(std::llround(time * world_.settings().update_rate));
    Readings said = gaps_;
    for (int probe = 0; probe < kProbes; ++probe) said[probe] += noise_.OfProbe(probe, tick, time);
    hidden_.Say(said);
    return said;
  }

  double Gap(const RigChannel& channel, const Readings& gaps, std::uint32_t& flags) const {
    const double gap = gaps[channel.index];
    if (gap >= 0.0 && gap <= world_.settings().probes[channel.index].range) {
      return gap / channel.unit;
    }
    flags |= recording::kOutOfRange;
    return std::numeric_limits<double>::quiet_NaN();
  }

  const World& world_;
  const int axis_;
  const hal::SweepPlan plan_;
  const RecordSweepOptions options_;
  const SweepMotion motion_;
  SensorNoise noise_;
  Climate own_climate_;
  Climate& climate_;
  HiddenRun hidden_;
  Eigen::Vector3d axes_;              // as the controller shows them
  std::vector<RigChannel> channels_;  // of the columns from kFirstReading on
  recording::Recording sweep_;
  // The position at which `gaps_` were computed.
  Eigen::Vector3d gaps_at_ = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Readings gaps_{};
};

}  // namespace

std::vector<hal::Channel> ChannelsOf(const hal::DevicesSettings& devices) {
  std::vector<hal::Channel> channels;
  const hal::DevicesSettings read = hal::WithoutEncoders(devices);
  for (const auto& device : read.devices) {
    for (const std::string& name : device->channels()) channels.push_back({name, device->name()});
  }
  return channels;
}

recording::Recording RecordSweep(const World& world, char axis,
                                 const std::vector<hal::Channel>& channels,
                                 const RecordSweepOptions& options) {
  const int number = AxisNumber(axis);
  const double most = world.settings().update_rate;
  if (!world.settings().sweeps[number]) {
    throw InputError(
        fmt::format("no sweep of {:c} is programmed; add a table [sweep.{:c}] to the "
                    "machine file",
                    axis, axis));
  }
  if (!(options.rate > 0.0 && options.rate <= most)) {
    throw InputError(
        fmt::format("the rate {} Hz must be above 0 and at most the sensors' {} Hz "
                    "(rig.update_hz)",
                    options.rate, most));
  }
  return SweepMaker(world, number, channels, options).Make();
}

}  // namespace abbe::rig
