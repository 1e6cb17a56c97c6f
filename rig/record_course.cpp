#include "rig/record_course.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "rig/noise.h"
#include "rig/streams.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

using Eigen::Vector3d;
using nlohmann::ordered_json;

using settings::kMillimetre;
constexpr double kMetrePerSecond = 60e3;  // in mm/min

// The rows of one recording as they are made.
class CourseMaker {
 public:
  CourseMaker(const LinkageRig& rig, const CourseOptions& options)
      : rig_(rig),
        options_(options),
        linkage_(options.kind == "linkage"),
        with_reference_(options.reference || !linkage_),
        own_climate_(rig.world().settings(), rig.world().seed(), options.run,
                     SensorsOf(rig, options)),
        climate_(options.climate != nullptr ? *options.climate : own_climate_),
        hidden_(rig.world().hidden(), climate_, {.begin = options.begin}),
        encoders_(rig.world().seed(), kEncoderNoiseStream + kRunStreams * options.run,
                  rig.linkage().settings().encoder_noise),
        ball_(rig.world().seed(), kBallStream + kRunStreams * options.run,
              rig.linkage().settings().repeatability),
        seat_(rig.SeatIn(options.run)),
        reference_(rig.world().seed(), kReferenceNoiseStream + kRunStreams * options.run,
                   rig.linkage().settings().reference_noise) {
    if (!linkage_ && options.kind != "reference") {
      throw InputError(
          fmt::format("the rig makes no recording of kind \"{}\" of a course; ask for \"linkage\" "
                      "or \"reference\"",
                      options.kind));
    }
    std::vector<std::string> names{"time_s", "x_mm",      "y_mm",       "z_mm",
                                   "pass",   "direction", "feed_mm_min"};
    if (linkage_) names.insert(names.end(), {"pivot_1_rad", "pivot_2_rad", "pivot_3_rad"});
    if (with_reference_) names.insert(names.end(), {"ref_x_mm", "ref_y_mm", "ref_z_mm"});
    sensors_ = SensorsOf(rig, options);
    names.insert(names.end(), sensors_.begin(), sensors_.end());
    if (linkage_) names.emplace_back("cap_force_n");
    names.emplace_back("flags");
    for (const std::string& name : names) course_.columns.push_back({name, {}});
    course_.header = fmt::format(
        "kind = \"{}\"\nmachine = {}\nstarted = \"{}\"\nsource = \"rig\"\n{}\n[rig]\nseed = "
        "{}\n"
        "run = {}\n{}",
        options.kind, settings::Quoted(rig.world().settings().name), options.started, options.keys,
        rig.world().seed(), options.run, options.tables);
    course_.name = fmt::format("rig {}, seed {}", options.kind, rig.world().seed());
  }

  // To be called for every step, also between the rows.
  void Follow(const CourseState& state) {
    hidden_.Follow(state.time, state.position, state.velocity);
    if (linkage_ && !hidden_.empty()) {
      rig_.Follow(state, TemperatureAt(state.time), Force(), hidden_);
    }
  }

  void Add(const CourseState& state) {
    column_ = 0;
    const auto row = course_.rows();
    Put(state.time);
    for (const double each : state.position) Put(each / kMillimetre);
    Put(state.pass);
    Put(state.direction);
    Put(state.feed * kMetrePerSecond);
    if (linkage_) AddAngles(state, TemperatureAt(state.time), row);
    if (with_reference_) {
      const Vector3d place = rig_.ReferenceAt(hidden_.Place()) + reference_.At(row);
      for (const double each : place) Put(each / kMillimetre);
    }
    for (const std::string& sensor : sensors_)
      Put(climate_.At(sensor, options_.begin + state.time));
    if (linkage_) Put(Force());
    Put(0.0);
  }

  recording::Recording Take() { return std::move(course_); }

 private:
  static std::vector<std::string> SensorsOf(const LinkageRig& rig, const CourseOptions& options) {
    std::vector<std::string> sensors;
    const std::string& links = rig.linkage().settings().temperature;
    if (!links.empty()) sensors.push_back(links);
    for (const std::string& sensor : options.sensors) {
      if (sensor != links) sensors.push_back(sensor);
    }
    return sensors;
  }

  // The temperature of the links.
  double TemperatureAt(double time) {
    return climate_.At(rig_.linkage().settings().temperature, options_.begin + time);
  }

  double Force() const {
    return options_.cap_force > 0.0 ? options_.cap_force : rig_.world().settings().cap_force;
  }

  void AddAngles(const CourseState& state, double temperature, std::uint64_t row) {
    const double count = 2.0 * std::numbers::pi / rig_.world().settings().encoder_counts;
    Vector3d angles =
        rig_.EncodersAt(state, temperature, Force(), hidden_, seat_ + ball_.At(state.position)) +
        encoders_.At(row);
    // Continuous where an angle passes pi.
    for (Eigen::Index i = 0; i < kPivots; ++i) {
      angles[i] = before_[i] + std::remainder(angles[i] - before_[i], 2.0 * std::numbers::pi);
    }
    before_ = angles;
    hidden_.Say(angles);
    for (const double angle : angles) Put(count * std::round(angle / count));
  }

  void Put(double value) { course_.columns[column_++].values.push_back(value); }

  const LinkageRig& rig_;
  const CourseOptions options_;
  const bool linkage_, with_reference_;
  Climate own_climate_;
  Climate& climate_;
  HiddenRun hidden_;
  std::vector<std::string> sensors_;
  WhiteNoise encoders_;
  BallSeat ball_;
  Vector3d seat_;
  WhiteNoise reference_;
  recording::Recording course_;
  std::size_t column_ = 0;
  Vector3d before_ = Vector3d::Zero();  // angles of the last row
};

ordered_json Listed(const Vector3d& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

ordered_json Listed(const std::vector<Harmonic>& harmonics) {
  ordered_json list = ordered_json::array();
  for (const Harmonic& each : harmonics) {
    list.push_back({{"order", each.order}, {"sine", each.sine}, {"cosine", each.cosine}});
  }
  return list;
}

}  // namespace

LinkageRig::LinkageRig(World world, Linkage linkage)
    : world_(std::move(world)), linkage_(std::move(linkage)) {}

Vector3d LinkageRig::ToolAt(const Vector3d& position) const {
  const Displacement table = world_.PoseOfTarget(position);
  const Vector3d tool = world_.PoseOfHead(position) * Vector3d::Zero();
  return table.rotation.transpose() * (tool - table.translation);
}

Vector3d LinkageRig::ReferenceAt(const Vector3d& position) const {
  Vector3d place = ToolAt(position);
  for (int axis = 0; axis < kAxes; ++axis) {
    place[axis] *= world_.settings().ToolWay(axis);
  }
  return place;
}

Vector3d LinkageRig::TrailingAt(const Vector3d& velocity, double cap_force) const {
  const RigSettings& machine = world_.settings();
  const Vector3d moving = machine.HeadTravel(velocity) - machine.TargetTravel(velocity);
  const double feed = moving.norm();
  if (feed == 0.0) return Vector3d::Zero();
  const double amount =
      machine.cap * machine.cap_force / cap_force * feed / (feed + machine.cap_feed);
  return -amount / feed * moving;
}

Vector3d LinkageRig::SeatIn(std::uint64_t run) const {
  return WhiteNoise(world_.seed(), kSeatStream + kRunStreams * run, linkage_.settings().seat).At(0);
}

Vector3d LinkageRig::BallFrom(HiddenRun& hidden) const {
  const RigSettings& machine = world_.settings();
  const Vector3d& place = hidden.Place();
  return hidden.BallFrom(machine.HeadTravel(place) - machine.TargetTravel(place));
}

void LinkageRig::Follow(const CourseState& state, double temperature, double cap_force,
                        HiddenRun& hidden) const {
  if (hidden.drags_ball()) BallFrom(hidden);
  if (hidden.WantsTurns()) EncodersAt(state, temperature, cap_force, hidden);
}

Vector3d LinkageRig::EncodersAt(const CourseState& state, double temperature, double cap_force,
                                HiddenRun& hidden, const Vector3d& seat) const {
  const Vector3d place = state.position + hidden.OffsetFor(Source::kAngles);
  Vector3d ball = ToolAt(place) + TrailingAt(state.velocity, cap_force) + seat;
  if (hidden.drags_ball()) ball += BallFrom(hidden);
  const Vector3d turns = linkage_.TurnsForPlace(ball, temperature);
  return linkage_.EncodersAt(turns) + hidden.EncodersShow(turns);
}

Vector3d LinkageRig::EncodersAt(const CourseState& state, double temperature,
                                double cap_force) const {
  const Vector3d ball = ToolAt(state.position) + TrailingAt(state.velocity, cap_force);
  return linkage_.EncodersFor(ball, temperature);
}

recording::Recording LinkageRig::Record(const Course& course, const CourseOptions& options) const {
  const RigSettings& machine = world_.settings();
  if (!(options.rate > 0.0 && options.rate <= machine.update_rate)) {
    throw InputError(
        fmt::format("the rate {} Hz must be above 0 and at most the sensors' {} Hz "
                    "(rig.update_hz)",
                    options.rate, machine.update_rate));
  }
  const double step = options.step > 0.0 ? options.step : 1.0 / machine.update_rate;
  RefuseTooLong(CourseRun::DurationOf(course, {machine.acceleration, machine.lag}, step),
                options.rate);
  CourseMaker maker(*this, options);
  CourseRun run(course, {machine.acceleration, machine.lag}, step);
  double next = 0.0;
  while (run.Next()) {
    const CourseState& state = run.state();
    maker.Follow(state);
    if (!state.counts || state.time < next) continue;
    next = state.time + 1.0 / options.rate - 0.5 * step;
    maker.Add(state);
  }
  return maker.Take();
}

ordered_json LinkageRig::Truth() const {
  ordered_json truth;
  for (std::size_t i = 0; i < kPivots; ++i) {
    const PivotTruth& pivot = linkage_.pivots()[i];
    truth[fmt::format("pivot_{}", i + 1)] = {{"point_m", Listed(pivot.point)},
                                             {"direction", Listed(pivot.direction)},
                                             {"run_out_first_m", Listed(pivot.run_out[0])},
                                             {"run_out_second_m", Listed(pivot.run_out[1])},
                                             {"encoder_zero_rad", pivot.encoder_zero},
                                             {"encoder_rad", Listed(pivot.encoder)},
                                             {"give_rad", pivot.give}};
  }
  truth["ball_m"] = Listed(linkage_.ball());
  truth["expansion_per_k"] = linkage_.expansion();
  truth["base"] = {{"position_m", Listed(linkage_.base().translation)},
                   {"x", Listed(linkage_.base().rotation.col(0))},
                   {"y", Listed(linkage_.base().rotation.col(1))},
                   {"z", Listed(linkage_.base().rotation.col(2))}};
  return truth;
}

}  // namespace abbe::rig
