#include "diagnosis/run_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <utility>

#include "diagnosis/planned_paths.h"
#include "diagnosis/planned_run.h"
#include "diagnosis/repeated_run.h"
#include "failure/failure.h"
#include "recording/good_rows.h"
#include "simulation/arm/arm_run.h"

namespace abbe::diagnosis {
namespace {

using Eigen::Vector3d;
using recording::Recording;

constexpr double kPauseBetweenRuns = 60.0;  // s, before the next run
constexpr double kHour = 3600.0;            // s
constexpr double kWarmer = 3.0;             // K
constexpr double kOtherFeed = 5.0;          // times
constexpr double kShift = 10e-3;            // m, of the target

constexpr const char* kAnew = "planned anew";

std::string NameOf(const Recording& recording) {
  return std::filesystem::path(recording.name).stem().string();
}

class Catalogue {
 public:
  Catalogue(const Campaign& campaign, const std::vector<Recording>& recordings)
      : campaign_(campaign), setup_(campaign.setup()) {
    about_.machine = setup_.machine.name;
    for (const Recording& recording : recordings) Look(recording);
    about_.started += kPauseBetweenRuns;
  }

  std::vector<PossibleRun> Make() {
    for (const auto& [axis, sweep] : sweeps_) AddSweeps(axis, *sweep);
    if (setup_.linkage) {
      if (moving_ != nullptr) AddOtherFeed(*moving_);
      for (const Recording* run : {moving_, standing_}) {
        if (run != nullptr) AddAgain(*run);
      }
      AddCircles();
    }
    for (const char axis : {'X', 'Y', 'Z'}) {
      Add(fmt::format("measure a length along {} (interferometer or step gauge)", axis),
          LengthPath(axis, Middle(), TravelOf(axis), about_));
    }
    return std::move(runs_);
  }

 private:
  void Look(const Recording& recording) {
    about_.started =
        std::max(about_.started, simulation::StartedOf(recording) + DurationOf(recording));
    for (const auto& column : recording.columns) {
      if (column.name.starts_with("temp_") && !column.values.empty()) {
        about_.temperature[column.name] = column.values.back();
      }
    }
    if (recording.Kind() == "sweep") {
      sweeps_.emplace(recording.HeaderText("axis").value_or("X")[0], &recording);
    } else if (recording.Kind() == "linkage" && !simulation::IsArm(recording)) {
      const Recording*& first = Moves(recording) ? moving_ : standing_;
      if (first == nullptr) first = &recording;
    }
  }

  Recording Later(const Recording& run, const std::string& mounting = {},
                  const simulation::SweepMounting& mounted = {}) const {
    return Again(run, {about_.machine, about_.started, mounting, mounted});
  }

  Recording AnHourLater(const Recording& run) const {
    return Warmer(Again(run, {about_.machine, about_.started + kHour}), kWarmer);
  }

  void AddSweeps(char axis, const Recording& sweep) {
    const std::string name = NameOf(sweep);
    const auto& travel = TravelOf(axis);
    const double range = setup_.head->probes[0].range;
    const double tilt = std::min(500e-6, 0.25 * range / (travel.last - travel.first));
    Add(fmt::format("mount the target anew, tilted by {:.0f} urad, and repeat {}", 1e6 * tilt,
                    name),
        Later(sweep, kAnew), tilt);
    Add(fmt::format("shift the target by {:.0f} mm along the axis and repeat {}", 1e3 * kShift,
                    name),
        Later(sweep, kAnew, {.target_shift = kShift}));
    Add(fmt::format("turn the target round by half a turn and repeat {}", name),
        Later(sweep, kAnew, {.target_reversed = true}));
    Add(fmt::format("turn the head by half a turn about its normal and repeat {}", name),
        Later(sweep, kAnew, {.head_turned = true}));
    Add(fmt::format("repeat {} in the reverse order, from the other end", name),
        TurnedRound(Later(sweep)));
    Add(fmt::format("repeat {} an hour later, the machine {:.0f} K warmer", name, kWarmer),
        AnHourLater(sweep));
    AddBeside(axis, sweep);
  }

  // With the head where the sweep has it.
  void AddBeside(char axis, const Recording& sweep) {
    const auto rows = recording::GoodRows(sweep);
    Vector3d first, last;  // of the sweep; its rows may leave the travel by their window
    for (const char each : {'X', 'Y', 'Z'}) {
      const int k = each - 'X';
      const auto position = recording::ValuesOf(sweep, fmt::format("{}_mm", "xyz"[k]), rows);
      const auto [least, most] = std::minmax_element(position.begin(), position.end());
      const auto& travel = TravelOf(each);
      first[k] = std::clamp(each == axis ? *least : position.front(), travel.first, travel.last);
      last[k] = std::clamp(*most, travel.first, travel.last);
    }
    const int swept = axis - 'X';
    Add(fmt::format("record gap steps beside {}: at three stations of {} the other axes step by "
                    "45 um to and fro",
                    NameOf(sweep), axis),
        GapStepPath(axis, first,
                    {first[swept], std::midpoint(first[swept], last[swept]), last[swept]}, about_));
    if (axis == sweeps_.begin()->first) {
      Add("hold still for some seconds where the sweep begins, and record the probes",
          StillPath(axis, first, about_));
    }
  }

  void AddOtherFeed(const Recording& run) {
    constexpr double kFast = 300.0;  // mm/min
    const auto column = run.Find("feed_mm_min");
    const double feed = column ? *std::max_element(column->begin(), column->end()) : 0.0;
    const double times = feed == 0.0 || feed >= kFast ? 1.0 / kOtherFeed : kOtherFeed;
    Add(feed == 0.0 ? fmt::format("repeat {} at a fifth of its feed", NameOf(run))
                    : fmt::format("repeat {} at {:.0f} mm/min instead of {:.0f}", NameOf(run),
                                  times * feed, feed),
        AtFeed(Later(run), times));
  }

  void AddAgain(const Recording& run) {
    const std::string name = NameOf(run);
    Add(fmt::format("repeat {} in the reverse order", name), TurnedRound(Later(run)));
    Add(fmt::format("take the linkage's base off, set it up anew and repeat {}", name),
        Later(run, kAnew));
    Add(fmt::format("repeat {} an hour later, the machine {:.0f} K warmer", name, kWarmer),
        AnHourLater(run));
    if (!setup_.linkage->pivots) return;
    relm::LinkageSettings other = *setup_.linkage;
    other.branch.elbow =
        other.branch.elbow == relm::Elbow::kUp ? relm::Elbow::kDown : relm::Elbow::kUp;
    Add(fmt::format("repeat {} with the linkage's elbow {}", name,
                    other.branch.elbow == relm::Elbow::kUp ? "up" : "down"),
        Later(run), 0.0, &other);
  }

  void AddCircles() {
    constexpr double kOften = 600.0;  // mm/min
    double smallest = TravelOf('X').last - TravelOf('X').first;
    for (const auto& travel : setup_.machine.travels) {
      smallest = std::min(smallest, travel.last - travel.first);
    }
    const auto add = [&](const char* plane, double radius) {
      Add(fmt::format("record a circle in {} of radius {:.3g} mm at {:.0f} mm/min, in both senses",
                      plane, 1e3 * radius, kOften),
          CirclePath({plane, Middle(), radius, kOften * 1e-3 / 60.0}, about_));
    };
    for (const char* plane : {"XY", "YZ", "ZX"}) add(plane, smallest / 3.0);
    add("XY", smallest / 6.0);
  }

  void Add(std::string text, Recording path, double target_tilt = 0.0,
           const relm::LinkageSettings* linkage = nullptr) {
    try {
      path = Planned(std::move(path), setup_);
      if (linkage != nullptr) SetAngles(setup_, *linkage, path);
    } catch (const NumericalError&) {
      return;  // out of reach
    }
    const double seconds = DurationOf(path) + simulation::StartedOf(path) - about_.started;
    path.name = fmt::format("planned {}", runs_.size() + 1);  // unknowns of its own
    Campaign alone(setup_, campaign_.origin());
    alone.Add(std::move(path));
    DiagnosedRun run = alone.runs().front();
    for (auto& block : run.simulated.blocks) {
      if (target_tilt == 0.0 || !block.name.starts_with("target_tilt")) continue;
      for (auto& entry : block.entries) entry.value = target_tilt;
    }
    runs_.push_back({std::move(text), seconds, std::move(run)});
  }

  const machine::Travel& TravelOf(char axis) const {
    return setup_.machine.travels[static_cast<std::size_t>(axis - 'X')];
  }

  Vector3d Middle() const {
    Vector3d middle;
    for (const char axis : {'X', 'Y', 'Z'}) {
      middle[axis - 'X'] = std::midpoint(TravelOf(axis).first, TravelOf(axis).last);
    }
    return middle;
  }

  const Campaign& campaign_;
  const Setup& setup_;
  PathAbout about_;
  std::map<char, const Recording*> sweeps_;  // the first of each axis
  const Recording *moving_ = nullptr, *standing_ = nullptr;
  std::vector<PossibleRun> runs_;
};

}  // namespace

std::vector<PossibleRun> PossibleRuns(const Campaign& campaign,
                                      const std::vector<Recording>& recordings) {
  return Catalogue(campaign, recordings).Make();
}

}  // namespace abbe::diagnosis
