#include "rig/campaign.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>

#include "failure/failure.h"
#include "rig/motion.h"
#include "rig/probe_runs.h"
#include "rig/record_course.h"
#include "rig/record_lengths.h"
#include "rig/record_sweep.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

using Eigen::Vector3d;

constexpr double kFast = 600.0 * settings::kMillimetrePerMinute;
constexpr double kSlow = 120.0 * settings::kMillimetrePerMinute;
constexpr double kPause = 30.0;            // s, between two recordings
constexpr double kWarming = 3600.0;        // s, before the repeat
constexpr double kWarmer = 3.0;            // K
constexpr double kTargetShift = 3e-3;      // m
constexpr std::uint64_t kFirstRun = 0x40;  // its noise is that of no single recording

// The sizes that differ between a whole and a reduced campaign.
struct Size {
  std::size_t stations;  // of a sweep, at most; 0: those of the machine file
  double sweep_rate;     // Hz; no divisor of the mains in a reduced campaign
  double circle_rows;    // in a turn; 0: as many as 100 a second at the fast feed
  Eigen::Vector3i cube;
  double cube_rate, cube_dwell;
  double step;  // s, of a course
};
const Size kWhole{0, 200.0, 0.0, {7, 7, 12}, 100.0, 0.5, 0.0};
const Size kReduced{16, 1.0 / 0.047, 180.0, {4, 4, 5}, 50.0, 0.1, 4e-3};

// One recording of the plan.
struct Step {
  std::string name;
  double duration;  // s, at most
  bool probes, linkage;
  std::function<recording::Recording(Step&)> record;
  bool warm = false;
  // Known when it is made.
  std::uint64_t run = 0;
  double begin = 0.0;
  std::string started = {};
};

// The mounting of head and target, elbow and base of the linkage; their header entries.
struct Place {
  Mounting mounting = {};
  const char* id = "first";
  bool other_elbow = false;
  std::uint64_t base = 0;
};
const Place kAsMounted{};
const Place kTargetAgain{{1, kTargetShift, true, false}, "second"};
const Place kHeadTurned{{2, 0.0, false, true}, "third"};
const Place kOtherElbow{.other_elbow = true};
const Place kOtherBase{.base = 1};

class CampaignMaker {
 public:
  CampaignMaker(const CampaignMachine& machine, std::uint64_t seed, HiddenEffects hidden,
                const CampaignPlan& plan)
      : machine_(machine),
        seed_(seed),
        plan_(plan),
        size_(plan.reduced ? kReduced : kWhole),
        climate_(machine.rig, seed, kFirstRun, machine.sensors.columns) {
    made_.hidden = std::move(hidden);
    if (size_.stations > 0) ThinSweeps(machine_, size_.stations);
  }

  Campaign Make() {
    AddRuns();
    if (steps_.empty()) {
      throw InputError(fmt::format(
          "{}: has nothing to record: add tables [sweep.X] or [linkage] to the machine file",
          machine_.rig.name));
    }
    Schedule();
    for (Step& step : steps_) {
      climate_.Warm(step.warm ? kWarmer : 0.0);
      recording::Recording recording = step.record(step);
      recording.name = step.name;
      made_.recordings.push_back(std::move(recording));
    }
    return std::move(made_);
  }

 private:
  // ---- the recordings, in order
  void AddRuns() {
    const bool standard = plan_.kind != CampaignKind::kMinimal;
    for (const char axis : {'X', 'Y', 'Z'}) AddSweep(axis, standard ? 5 : 1, kAsMounted);
    AddCircle('Z', kFast, 1.0, kAsMounted);
    if (!standard) return;
    AddCircle('Z', kSlow, 1.0, kAsMounted);
    for (const char normal : {'X', 'Y'}) {
      for (const double feed : {kFast, kSlow}) AddCircle(normal, feed, 1.0, kAsMounted);
    }
    AddCube(kAsMounted);
    AddDwell();
    AddLength();
    if (plan_.kind == CampaignKind::kFull) AddMore();
  }

  void AddMore() {
    for (const char axis : {'X', 'Y', 'Z'}) AddGapSteps(axis);
    for (const Place& place : {kTargetAgain, kHeadTurned}) {
      for (const char axis : {'X', 'Y', 'Z'}) AddSweep(axis, 2, place);
    }
    for (const Place& place : {kOtherElbow, kOtherBase}) {
      AddCircle('Z', kFast, 1.0, place);
      AddCube(place);
    }
    AddCircle('Z', kFast, 0.5, kAsMounted);
    AddSquare();
    AddStepping();
    const std::size_t first_warm = steps_.size();
    for (const char axis : {'X', 'Y', 'Z'}) AddSweep(axis, 2, kAsMounted);
    AddCircle('Z', kFast, 1.0, kAsMounted);
    AddLength();
    for (std::size_t i = first_warm; i < steps_.size(); ++i) {
      steps_[i].warm = true;
      steps_[i].name += "_warm";
    }
  }

  void AddSweep(char axis, int passes, const Place& place) {
    const auto& plan = machine_.rig.sweeps[AxisNumber(axis)];
    if (!plan) return;
    hal::SweepPlan planned = *plan;
    planned.passes = passes;
    const RigSettings& rig = machine_.rig;
    const SweepMotion motion(planned, {rig.acceleration, rig.lag}, 0.0);
    const auto record = [this, axis, passes, place](Step& step) {
      return RecordSweep(WorldOf(place), axis, machine_.channels,
                         {.rate = size_.sweep_rate,
                          .moving = false,
                          .run = step.run,
                          .mounting = place.id,
                          .started = step.started,
                          .more = HeadText(place.mounting),
                          .passes = passes,
                          .begin = step.begin,
                          .climate = &climate_});
    };
    Add(fmt::format("sweep_{:c}", axis) + Suffix(place), motion.duration(), true, false, record);
  }

  void AddGapSteps(char axis) {
    if (!machine_.rig.sweeps[AxisNumber(axis)]) return;
    ProbeRunOptions options = ProbeRun();
    const double duration =
        Duration(GapStepCourse(machine_.rig, axis, options), 1.0 / options.rate);
    const auto record = [this, axis, options](Step& step) {
      return RecordGapSteps(WorldOf(kAsMounted), axis, At(options, step));
    };
    Add(fmt::format("gap_steps_{:c}", axis), duration, true, false, record);
  }

  void AddDwell() {
    if (!machine_.rig.sweeps[0]) return;
    const auto record = [this](Step& step) {
      ProbeRunOptions options = At(ProbeRun(), step);
      const LinkageRig* rig = machine_.linkage ? &RigOf(kAsMounted) : nullptr;
      if (rig != nullptr) {
        options.keys += ElbowText(kAsMounted);
        options.tables += "base = \"first\"\n";
      }
      return RecordDwell(WorldOf(kAsMounted), 'X', rig, options);
    };
    Add("dwell", ProbeRun().length, true, machine_.linkage.has_value(), record);
  }

  void AddLength() {
    if (!machine_.linkage) return;
    LengthProgram program;
    program.at = Middle();
    const auto [first, last] = machine_.rig.travels[0];
    program.step = (last - first) / program.count;
    const auto record = [this, program](Step& step) mutable {
      program.run = step.run;
      program.started = step.started;
      program.begin = step.begin;
      program.sensors = machine_.sensors.columns;
      program.climate = &climate_;
      return RecordLengths(RigOf(kAsMounted), program);
    };
    Add("length_X", program.count, false, false, record);
  }

  void AddCircle(char normal, double feed, double share, const Place& place) {
    const double radius = share * Smallest() / 3.0;
    const int first = (normal - 'X' + 1) % kAxes;
    const std::string plane = {static_cast<char>('X' + first),
                               static_cast<char>('X' + (first + 1) % kAxes)};
    const double turn = 2.0 * std::numbers::pi * radius;
    const double rate =
        (size_.circle_rows > 0.0 ? size_.circle_rows : 100.0 * turn / kFast) * feed / turn;
    AddCourse("circle",
              fmt::format("circle_{}_{:.0f}mm_{:.0f}", plane, 1e3 * radius,
                          feed / settings::UnitOf("feed_mm_min").si),
              CircleCourse({.normal = normal, .centre = Middle(), .radius = radius, .feed = feed}),
              rate, place, fmt::format("axis = \"{}\"\nradius_mm = {:.9g}\n", plane, 1e3 * radius));
  }

  void AddCube(const Place& place) {
    Vector3d size;
    const Vector3d share(25.0 / 60.0, 25.0 / 60.0, 50.0 / 60.0);
    for (int axis = 0; axis < kAxes; ++axis) {
      const auto [first, last] = machine_.rig.travels[axis];
      size[axis] = share[axis] * (last - first);
    }
    AddCourse("cube", "cube",
              DwellCourse(GridPlaces(Middle(), size, size_.cube), kFast, size_.cube_dwell, 1),
              size_.cube_rate, place);
  }

  void AddSquare() {
    AddCourse("square", "square",
              SquareCourse({.centre = Middle(), .side = 2.0 * Smallest() / 3.0, .feed = kFast}),
              size_.circle_rows > 0.0 ? 10.0 : 100.0, kAsMounted);
  }

  void AddStepping() {
    const double length = 25.0 / 60.0 * Smallest();
    const Vector3d start = Middle() - Vector3d::Constant(0.5 * length);
    AddCourse("stepping", "stepping",
              DwellCourse(SteppingPlaces(start, length / 5.0, 5), kFast, size_.cube_dwell, 1),
              size_.cube_rate, kAsMounted);
  }

  void AddCourse(const char* course, const std::string& name, Course path, double rate,
                 const Place& place, const std::string& keys = {}) {
    if (!machine_.linkage) return;
    const double duration = Duration(path, size_.step > 0.0 ? size_.step : UpdateStep());
    const auto record = [this, course, path = std::move(path), rate, place, keys](Step& step) {
      return RigOf(place).Record(
          path, {.rate = rate,
                 .run = step.run,
                 .started = step.started,
                 .keys = fmt::format("course = \"{}\"\n", course) + keys + ElbowText(place),
                 .tables = fmt::format("[mounting]\nbase = \"{}\"\n",
                                       place.base == 0 ? "first" : "second"),
                 .sensors = machine_.sensors.columns,
                 .step = size_.step,
                 .begin = step.begin,
                 .climate = &climate_});
    };
    Add(name + Suffix(place), duration, false, true, record);
  }

  void Add(std::string name, double duration, bool probes, bool linkage,
           std::function<recording::Recording(Step&)> record) {
    steps_.push_back({std::move(name), duration, probes, linkage, std::move(record)});
  }

  // ---- their times
  void Schedule() {
    double begin = 0.0;
    bool warm = false;
    std::vector<RecordedTime> times;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      Step& step = steps_[i];
      if (step.warm && !warm) begin += kWarming;
      warm = step.warm;
      step.begin = begin;
      step.run = kFirstRun + i;
      step.name = fmt::format("{:02}_{}", i + 1, step.name);
      const auto at = plan_.started + std::chrono::seconds(static_cast<std::int64_t>(begin));
      step.started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", at);
      times.push_back({begin, step.duration, step.probes, step.linkage});
      begin = std::ceil(begin + step.duration + kPause);
    }
    std::vector<double> turns;
    if (machine_.linkage) {
      const World world(machine_.rig, seed_);
      const Linkage linkage(*machine_.linkage, seed_);
      const Vector3d at_middle = linkage.TurnsForPlace(LinkageRig(world, linkage).ToolAt(Middle()),
                                                       machine_.rig.temperature);
      turns.assign(at_middle.begin(), at_middle.end());
    }
    SetInTime(made_.hidden, times, turns);
  }

  double Duration(const Course& course, double step) const {
    return CourseRun::DurationOf(course, {machine_.rig.acceleration, machine_.rig.lag}, step);
  }
  double UpdateStep() const { return 1.0 / machine_.rig.update_rate; }

  // ---- their machines
  const World& WorldOf(const Place& place) {
    auto& world = worlds_[place.mounting.number];
    if (!world) world = std::make_unique<World>(machine_.rig, seed_, made_.hidden, place.mounting);
    return *world;
  }

  const LinkageRig& RigOf(const Place& place) {
    auto& rig = rigs_[(place.other_elbow ? 1 : 0) + (place.base > 0 ? 2 : 0)];
    if (!rig) {
      LinkageSettings settings = *machine_.linkage;
      settings.elbow_up = settings.elbow_up != place.other_elbow;
      rig = std::make_unique<LinkageRig>(WorldOf(kAsMounted),
                                         Linkage(settings, seed_, made_.hidden, place.base));
    }
    return *rig;
  }

  Vector3d Middle() const {
    Vector3d middle;
    for (int axis = 0; axis < kAxes; ++axis) {
      const auto [first, last] = machine_.rig.travels[axis];
      middle[axis] = std::midpoint(first, last);
    }
    return middle;
  }

  double Smallest() const {
    double smallest = machine_.rig.travels[0].last - machine_.rig.travels[0].first;
    for (const AxisTravel& travel : machine_.rig.travels) {
      smallest = std::min(smallest, travel.last - travel.first);
    }
    return smallest;
  }

  // ---- their headers
  static std::string HeadText(const Mounting& mounting) {
    return fmt::format("head = \"{}\"\ntarget_shift_mm = {:.1f}\ntarget_reversed = {}\n",
                       mounting.head_turned ? "180deg" : "0deg",
                       mounting.target_shift / settings::kMillimetre, mounting.target_reversed);
  }

  std::string ElbowText(const Place& place) const {
    return fmt::format("elbow = \"{}\"\n",
                       machine_.linkage->elbow_up != place.other_elbow ? "up" : "down");
  }

  static std::string Suffix(const Place& place) {
    if (place.other_elbow) return "_other_elbow";
    if (place.base > 0) return "_second_base";
    return place.mounting.number > 0 ? fmt::format("_{}", place.id) : "";
  }

  ProbeRunOptions ProbeRun() const {
    ProbeRunOptions options;
    options.rate = size_.sweep_rate;
    options.sensors = machine_.sensors.columns;
    options.tables =
        fmt::format("[mounting]\nid = \"{}\"\n", kAsMounted.id) + HeadText(kAsMounted.mounting);
    return options;
  }

  ProbeRunOptions At(ProbeRunOptions options, const Step& step) {
    options.run = step.run;
    options.started = step.started;
    options.begin = step.begin;
    options.climate = &climate_;
    return options;
  }

  CampaignMachine machine_;
  const std::uint64_t seed_;
  const CampaignPlan plan_;
  const Size& size_;
  Climate climate_;
  std::array<std::unique_ptr<World>, 3> worlds_;
  std::array<std::unique_ptr<LinkageRig>, 4> rigs_;
  std::vector<Step> steps_;
  Campaign made_;
};

}  // namespace

Campaign RecordCampaign(const CampaignMachine& machine, std::uint64_t seed, HiddenEffects hidden,
                        const CampaignPlan& plan) {
  return CampaignMaker(machine, seed, std::move(hidden), plan).Make();
}

}  // namespace abbe::rig
