#include "rig/planned_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include "failure/failure.h"
#include "recording/instant.h"
#include "rig/probe_runs.h"
#include "rig/record_ballbar.h"
#include "rig/record_lengths.h"
#include "rig/record_sweep.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

using Eigen::Vector3d;
using recording::Recording;

constexpr std::uint64_t kFirstPlannedRun = 0x80;  // its noise is that of no run of a campaign
constexpr double kSweepRate = 1.0 / 0.047;        // Hz, no divisor of the mains
constexpr double kCourseStep = 4e-3;              // s
constexpr const char *kFirst = "first", *kMounted = "mounted ";

// What is mounted: 0 as at first; of "mounted 3" the 3; anything else is new, by the number of the
// run.
std::uint64_t NumberOf(const std::string& id, std::uint64_t run) {
  if (id.empty() || id == kFirst) return 0;
  if (id.starts_with(kMounted)) return std::stoull(id.substr(std::string(kMounted).size()));
  return run;
}

std::string IdOf(std::uint64_t number) {
  return number == 0 ? kFirst : fmt::format("{}{}", kMounted, number);
}

std::vector<Vector3d> PlacesOf(const Recording& path) {
  const auto x = path.At("x_mm"), y = path.At("y_mm"), z = path.At("z_mm");
  std::vector<Vector3d> places;
  places.reserve(x.size());
  for (std::size_t row = 0; row < x.size(); ++row) {
    places.push_back(settings::kMillimetre * Vector3d(x[row], y[row], z[row]));
  }
  return places;
}

double FeedOf(const Recording& path) {
  const auto feed = path.At("feed_mm_min");
  return std::ranges::max(feed) * settings::kMillimetrePerMinute;
}

// Each place where the machine stands, once; a recorded one still settles when its rows begin.
std::vector<Vector3d> StandsOf(const std::vector<Vector3d>& places) {
  constexpr double kWindow = 20e-6;  // m
  std::vector<Vector3d> stands;
  for (const Vector3d& each : places) {
    if (!stands.empty() && (stands.back() - each).norm() < kWindow) {
      stands.back() = each;
    } else {
      stands.push_back(each);
    }
  }
  return stands;
}

// The stations of the swept axis, in order: the middle of the rows about each.
std::vector<double> StationsOf(const std::vector<Vector3d>& places, int axis, double apart,
                               const AxisTravel& travel) {
  std::vector<double> along, stations;
  along.reserve(places.size());
  for (const Vector3d& place : places) along.push_back(place[axis]);
  std::ranges::sort(along);
  for (std::size_t first = 0, last = 0; first < along.size(); first = last) {
    while (last < along.size() && along[last] - along[first] < apart) ++last;
    stations.push_back(
        std::clamp(along[std::midpoint(first, last - 1)], travel.first, travel.last));
  }
  return stations;
}

// A motion with a run-in and a run-out: a quarter of itself for a closed path, straight on for
// another one. So each axis has moved before it counts.
struct Way {
  explicit Way(const std::vector<Vector3d>& points) {
    constexpr double kStraight = 2e-3;  // m
    const double step = (points[1] - points[0]).norm();
    const bool is_closed = (points.back() - points.front()).norm() < 2.0 * step;
    const auto quarter = static_cast<std::ptrdiff_t>(points.size() / 4);
    if (is_closed) {
      all.assign(points.end() - quarter, points.end());
    } else {
      all.push_back(points[0] - kStraight * (points[1] - points[0]).normalized());
    }
    const std::size_t first = all.size();
    all.insert(all.end(), points.begin(), points.end());
    if (is_closed) {
      all.insert(all.end(), points.begin(), points.begin() + quarter);
    } else {
      const Vector3d& before = points[points.size() - 2];
      all.push_back(points.back() + kStraight * (points.back() - before).normalized());
    }
    for (std::size_t i = 1; i < first + points.size(); ++i) {
      to += (all[i] - all[i - 1]).norm();
      if (i == first) from = to;
    }
  }
  std::vector<Vector3d> all;
  double from = 0.0, to = 0.0;  // m along it: what counts
};

// A path without stands: each pass in one motion.
Course MovingCourse(const Recording& path, const std::vector<Vector3d>& places) {
  const auto pass = path.At("pass"), direction = path.At("direction");
  Course course{places.front(), {}};
  for (std::size_t first = 0, last = 0; first < places.size(); first = last) {
    while (last < places.size() && pass[last] == pass[first] &&
           direction[last] == direction[first]) {
      ++last;
    }
    const auto points = StandsOf({places.begin() + first, places.begin() + last});
    if (points.size() < 2) continue;
    const Way way(points);
    if (course.moves.empty()) {
      course.start = way.all.front();
    } else {
      course.moves.push_back({{way.all.front()}, FeedOf(path), 0.5});
    }
    course.moves.push_back({{way.all.begin() + 1, way.all.end()},
                            FeedOf(path),
                            0.5,
                            static_cast<int>(pass[first]),
                            static_cast<int>(direction[first]),
                            way.from,
                            way.to});
  }
  return course;
}

}  // namespace

// One path with what its header says.
struct PlannedRecorder::Run {
  Run(const Recording& planned, std::uint64_t number_of_run, double campaign_started)
      : path(planned),
        number(number_of_run),
        run(kFirstPlannedRun + number_of_run),
        started(recording::SecondsOf(planned.HeaderText("started").value_or("")).value_or(0.0)),
        begin(started - campaign_started),
        axis(planned.HeaderText("axis").value_or("X").front()),
        mounting(NumberOf(planned.HeaderText("mounting.id").value_or(""), number)),
        base(NumberOf(planned.HeaderText("mounting.base").value_or(""), number)),
        places(PlacesOf(planned)) {}

  std::string Started() const { return recording::InstantText(started); }

  const Recording& path;
  std::uint64_t number, run;
  double started, begin;
  char axis;
  std::uint64_t mounting, base;
  std::vector<Vector3d> places;
};

namespace {

std::string HeadText(const Mounting& mounting) {
  return fmt::format("head = \"{}\"\ntarget_shift_mm = {:.1f}\ntarget_reversed = {}\n",
                     mounting.head_turned ? "180deg" : "0deg",
                     mounting.target_shift / settings::kMillimetre, mounting.target_reversed);
}

// Angles of the pivots in the middle of the travels.
std::vector<double> TurnsInTheMiddle(const CampaignMachine& machine, std::uint64_t seed) {
  if (!machine.linkage) return {};
  Vector3d middle;
  for (int axis = 0; axis < kAxes; ++axis) {
    const auto [first, last] = machine.rig.travels[axis];
    middle[axis] = std::midpoint(first, last);
  }
  const Linkage linkage(*machine.linkage, seed);
  const LinkageRig rig(World(machine.rig, seed), linkage);
  const Vector3d turns = linkage.TurnsForPlace(rig.ToolAt(middle), machine.rig.temperature);
  return {turns.begin(), turns.end()};
}

std::string TableOf(const Mounting& mounting) {
  return fmt::format("[mounting]\nid = {}\n", settings::Quoted(IdOf(mounting.number))) +
         HeadText(mounting);
}

}  // namespace

PlannedRecorder::PlannedRecorder(CampaignMachine machine, std::uint64_t seed, HiddenEffects hidden,
                                 double started)
    : machine_(std::move(machine)),
      seed_(seed),
      hidden_(std::move(hidden)),
      started_(started),
      climate_(machine_.rig, seed, kFirstPlannedRun, machine_.sensors.columns) {
  constexpr double kHour = 3600.0;  // s
  SetInTime(hidden_, {{0.0, kHour, true, true}}, TurnsInTheMiddle(machine_, seed));
}

// Who records a kind of run, and with which instrument.
struct PlannedRecorder::Kind {
  std::string_view name;
  bool takes_linkage;  // or the head
  Recording (PlannedRecorder::*record)(const Run&);
};

const PlannedRecorder::Kind* PlannedRecorder::KindOf(const Recording& path) {
  static constexpr std::array<Kind, 6> kKinds{{{"sweep", false, &PlannedRecorder::Sweep},
                                               {"gap-steps", false, &PlannedRecorder::GapSteps},
                                               {"dwell", false, &PlannedRecorder::Dwell},
                                               {"linkage", true, &PlannedRecorder::OfLinkage},
                                               {"ballbar", true, &PlannedRecorder::Ballbar},
                                               {"length", true, &PlannedRecorder::Length}}};
  const auto* kind = std::ranges::find(kKinds, std::string_view(path.Kind()), &Kind::name);
  return kind == kKinds.end() ? nullptr : kind;
}

bool PlannedRecorder::Records(const Recording& path) const {
  const Kind* kind = KindOf(path);
  if (kind == nullptr) return false;
  if (kind->takes_linkage) return machine_.linkage.has_value();
  const char axis = path.HeaderText("axis").value_or("X").front();
  return machine_.rig.sweeps[AxisNumber(axis)] && !path.HeaderText("mounting.swapped");
}

Recording PlannedRecorder::Record(const Recording& path, std::uint64_t number) {
  constexpr double kClearlyWarmer = 1.5;  // K: an hour later, not the weather
  const Run run(path, number, started_);
  double warmer = 0.0;
  for (const auto& column : path.columns) {
    if (column.name.starts_with("temp_") && !column.values.empty()) {
      warmer = std::max(warmer, column.values.front() - machine_.rig.temperature);
    }
  }
  climate_.Warm(warmer > kClearlyWarmer ? std::round(warmer) : 0.0);
  const Kind* kind = KindOf(path);
  if (kind == nullptr) {
    throw InputError(fmt::format("{}: the virtual rig records no {}; choose another run", path.name,
                                 path.Kind()));
  }
  return (this->*kind->record)(run);
}

Mounting PlannedRecorder::MountingOf(const Run& run) const {
  const Recording& path = run.path;
  return {.number = run.mounting,
          .target_shift =
              settings::kMillimetre * path.HeaderNumber("mounting.target_shift_mm").value_or(0.0),
          .target_reversed = path.HeaderText("mounting.target_reversed").value_or("") == "true",
          .head_turned = path.HeaderText("mounting.head").value_or("") == "180deg"};
}

LinkageRig PlannedRecorder::RigOf(const Run& run) const {
  LinkageSettings settings = *machine_.linkage;
  if (const auto elbow = run.path.HeaderText("elbow")) settings.elbow_up = *elbow == "up";
  return {World(machine_.rig, seed_, hidden_), Linkage(settings, seed_, hidden_, run.base)};
}

Recording PlannedRecorder::Sweep(const Run& run) {
  CampaignMachine planned = machine_;
  hal::SweepPlan& plan = *planned.rig.sweeps[AxisNumber(run.axis)];
  const int axis = AxisNumber(run.axis);
  plan.stations = StationsOf(run.places, axis, 4.0 * plan.window, planned.rig.travels[axis]);
  plan.passes = static_cast<int>(std::ranges::max(run.path.At("pass")));
  const Mounting mounting = MountingOf(run);
  const World world(planned.rig, seed_, hidden_, mounting);
  return RecordSweep(world, run.axis, machine_.channels,
                     {.rate = kSweepRate,
                      .moving = false,
                      .run = run.run,
                      .mounting = IdOf(mounting.number),
                      .started = run.Started(),
                      .more = HeadText(mounting),
                      .begin = run.begin,
                      .climate = &climate_});
}

Recording PlannedRecorder::GapSteps(const Run& run) {
  const Mounting mounting = MountingOf(run);
  return RecordGapSteps(World(machine_.rig, seed_, hidden_, mounting), run.axis,
                        {.rate = kSweepRate,
                         .run = run.run,
                         .started = run.Started(),
                         .tables = TableOf(mounting),
                         .sensors = machine_.sensors.columns,
                         .begin = run.begin,
                         .climate = &climate_});
}

Recording PlannedRecorder::Dwell(const Run& run) {
  const Mounting mounting = MountingOf(run);
  return RecordDwell(World(machine_.rig, seed_, hidden_, mounting), run.axis, nullptr,
                     {.rate = kSweepRate,
                      .length = kDwellInterval * run.places.size(),
                      .run = run.run,
                      .started = run.Started(),
                      .tables = TableOf(mounting),
                      .sensors = machine_.sensors.columns,
                      .begin = run.begin,
                      .climate = &climate_});
}

Recording PlannedRecorder::OfLinkage(const Run& run) {
  constexpr double kStand = 0.5, kStandRate = 10.0;  // s, Hz
  const LinkageRig rig = RigOf(run);
  const std::vector<Vector3d> stands = StandsOf(run.places);
  const bool stands_still = 2 * stands.size() < run.places.size();
  const Course course = stands_still ? DwellCourse(stands, FeedOf(run.path), kStand, 1)
                                     : MovingCourse(run.path, run.places);
  const auto time = run.path.At("time_s");
  const double rate = (time.size() - 1) / (time.back() - time.front());
  // A run that says nothing of it is mounted as the ones before.
  const auto elbow = run.path.HeaderText("elbow");
  return rig.Record(
      course, {.rate = stands_still ? kStandRate : rate,
               .run = run.run,
               .started = run.Started(),
               .keys = elbow ? fmt::format("elbow = \"{}\"\n", *elbow) : "",
               .tables = fmt::format("[mounting]\nbase = {}\n", settings::Quoted(IdOf(run.base))),
               .sensors = machine_.sensors.columns,
               .step = kCourseStep,
               .begin = run.begin,
               .climate = &climate_});
}

Recording PlannedRecorder::Ballbar(const Run& run) {
  const Recording& path = run.path;
  const auto centre = path.HeaderNumbers("centre_mm", 3);
  const auto radius = path.HeaderNumber("radius_mm");
  if (!centre || !radius) {
    throw InputError(path.name + ": a circle of a ballbar states centre_mm and radius_mm");
  }
  const BallbarProgram program{
      .plane = path.HeaderText("axis").value_or("XY"),
      .centre = settings::kMillimetre * Vector3d((*centre)[0], (*centre)[1], (*centre)[2]),
      .radius = settings::kMillimetre * *radius};
  std::vector<Vector3d> places = run.places;
  for (Vector3d& place : places) place += program.centre;
  const auto time = path.At("time_s");
  return RecordBallbar(RigOf(run), MovingCourse(path, places), program,
                       {.rate = (time.size() - 1) / (time.back() - time.front()),
                        .run = run.run,
                        .started = run.Started(),
                        .keys = fmt::format("radius_mm = {}\n", *radius),
                        .sensors = machine_.sensors.columns,
                        .step = kCourseStep,
                        .begin = run.begin,
                        .climate = &climate_});
}

Recording PlannedRecorder::Length(const Run& run) {
  const int axis = AxisNumber(run.axis);
  const int count = static_cast<int>(run.places.size()) - 1;
  LengthProgram program{.axis = run.axis,
                        .at = run.places.front(),
                        .step = (run.places.back()[axis] - run.places.front()[axis]) / count,
                        .count = count,
                        .run = run.run,
                        .started = run.Started(),
                        .sensors = machine_.sensors.columns,
                        .begin = run.begin,
                        .climate = &climate_};
  return RecordLengths(RigOf(run), program);
}

}  // namespace abbe::rig
