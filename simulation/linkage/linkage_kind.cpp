// Runs of the linkage that the machine carries: RELM on its axes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "settings/toml_text.h"
#include "settings/unit.h"
#include "simulation/kinds.h"
#include "simulation/linkage/linkage_correction.h"
#include "simulation/linkage/linkage_kinds.h"
#include "simulation/linkage/linkage_on_machine.h"
#include "simulation/linkage/linkage_parts.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_trace.h"
#include "simulation/linkage/one_ball.h"
#include "simulation/linkage/standing_linkage.h"
#include "simulation/planned_run.h"
#include "simulation/points/reference_simulation.h"
#include "simulation/repeated_run.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using recording::Recording;

constexpr const char *kBaseAnew = "planned anew", *kFirstBase = "first";
constexpr double kFast = 600.0 * settings::kMillimetrePerMinute;  // m/s, of new circles
constexpr double kSlow = 120.0 * settings::kMillimetrePerMinute;

LinkageSimulation Nominal(const Instruments& on, const relm::LinkageSettings& settings) {
  return {on.machine.chain, settings,
          relm::MakeLinkageModel(settings, relm::ErrorModel::kComplete)};
}

bool HasReference(const Recording& head) {
  return head.Find("ref_x_mm") || head.Find("ref_y_mm") || head.Find("ref_z_mm");
}

// Whether most of its rows are of a motion.
bool Moves(const Recording& run) {
  std::size_t moved = 0;
  for (std::size_t row = 1; row < run.rows(); ++row) {
    double way = 0.0;
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
      if (const auto column = run.Find(axis)) {
        way = std::max(way, std::abs((*column)[row] - (*column)[row - 1]));
      }
    }
    if (way * settings::kMillimetre > kStayWindow) ++moved;
  }
  return 2 * moved > run.rows();
}

// The box of the travels.
struct Volume {
  explicit Volume(const std::array<machine::Travel, 3>& travels) {
    for (std::size_t axis = 0; axis < travels.size(); ++axis) {
      size[axis] = travels[axis].last - travels[axis].first;
      middle[axis] = std::midpoint(travels[axis].first, travels[axis].last);
    }
    smallest = size.minCoeff();
  }
  Vector3d middle, size;
  double smallest;
};

NextRun CircleRun(CirclePlan plan, const PathAbout& about) {
  return {fmt::format("record a circle in {} of radius {:.3g} mm at {:.0f} mm/min, in both senses",
                      plan.plane, plan.radius / settings::kMillimetre,
                      plan.feed / settings::kMillimetrePerMinute),
          CirclePath(plan, about)};
}

// The runs that could follow those of a linkage.
class AfterLinkage {
 public:
  AfterLinkage(const std::vector<const Recording*>& recorded, const Instruments& on,
               const PathAbout& about)
      : on_(on), about_(about) {
    for (const Recording* each : recorded) {
      const Recording*& first = Moves(*each) ? moving_ : standing_;
      if (first == nullptr) first = each;
    }
  }

  std::vector<NextRun> Make() {
    if (moving_ != nullptr) AddOtherFeed(*moving_);
    for (const Recording* run : {moving_, standing_}) {
      if (run != nullptr) AddAgain(*run);
    }
    AddCircles();
    return std::move(runs_);
  }

 private:
  AgainAbout AsItWas(const Recording& run) const {
    return {about_.machine, about_.started, BaseLines(BaseOf(run))};
  }

  void AddOtherFeed(const Recording& run) {
    constexpr double kIsFast = 300.0;   // mm/min
    constexpr double kOtherFeed = 5.0;  // times
    const auto column = run.Find("feed_mm_min");
    const double feed = column ? *std::max_element(column->begin(), column->end()) : 0.0;
    const double times = feed == 0.0 || feed >= kIsFast ? 1.0 / kOtherFeed : kOtherFeed;
    runs_.push_back({feed == 0.0 ? fmt::format("repeat {} at a fifth of its feed", ShortName(run))
                                 : fmt::format("repeat {} at {:.0f} mm/min instead of {:.0f}",
                                               ShortName(run), times * feed, feed),
                     AtFeed(Again(run, AsItWas(run)), times)});
  }

  void AddAgain(const Recording& run) {
    const std::string name = ShortName(run);
    runs_.push_back({fmt::format("repeat {} in the reverse order", name),
                     TurnedRound(Again(run, AsItWas(run)))});
    runs_.push_back({fmt::format("take the linkage's base off, set it up anew and repeat {}", name),
                     Again(run, {about_.machine, about_.started, BaseLines(kBaseAnew)})});
    runs_.push_back(
        {fmt::format("repeat {} an hour later, the machine {:.0f} K warmer", name, kWarmer),
         AnHourLater(run, AsItWas(run))});
    if (!on_.linkage->pivots) return;
    auto other = std::make_shared<Instruments>(on_);
    relm::Elbow& elbow = other->linkage->branch.elbow;
    elbow = elbow == relm::Elbow::kUp ? relm::Elbow::kDown : relm::Elbow::kUp;
    runs_.push_back({fmt::format("repeat {} with the linkage's elbow {}", name,
                                 elbow == relm::Elbow::kUp ? "up" : "down"),
                     WithElbow(elbow, Again(run, AsItWas(run))), std::move(other)});
  }

  static Recording WithElbow(relm::Elbow elbow, Recording run) {
    run.header =
        fmt::format("elbow = \"{}\"\n", elbow == relm::Elbow::kUp ? "up" : "down") + run.header;
    return run;
  }

  void AddCircles() {
    const Volume volume(on_.machine.travels);
    const Recording* first = moving_ != nullptr ? moving_ : standing_;
    const std::string base = BaseLines(first != nullptr ? BaseOf(*first) : kFirstBase);
    const auto add = [&](const char* plane, double radius) {
      runs_.push_back(CircleRun({.plane = plane,
                                 .centre = volume.middle,
                                 .radius = radius,
                                 .feed = kFast,
                                 .mounting = base},
                                about_));
    };
    for (const char* plane : {"XY", "YZ", "ZX"}) add(plane, volume.smallest / 3.0);
    add("XY", volume.smallest / 6.0);
  }

  const Instruments& on_;
  const PathAbout& about_;
  const Recording *moving_ = nullptr, *standing_ = nullptr;  // the first of each
  std::vector<NextRun> runs_;
};

class LinkageRuns : public RunKind {
 public:
  std::string_view name() const override { return "linkage"; }
  bool Takes(const Recording& head) const override { return head.Kind() == name(); }

  // The base and the elbow.
  std::string MountingOf(const Recording& head) const override {
    return fmt::format("{} {}", head.HeaderText("mounting.base").value_or(kFirstBase),
                       head.HeaderText("elbow").value_or(""));
  }

  bool MakesMaps() const override { return true; }
  std::vector<SimulatedRun> ForMap(const RunSource& source, const machine::VolumetricModel& model,
                                   const Instruments& on) const override {
    const relm::LinkageSettings& settings = on.LinkageFor(source.head.name);
    const auto& reference = on.machine.reference;
    std::vector<SimulatedRun> runs{
        SimulateLinkage(model, reference, Nominal(on, settings), PartsOf(source.blocks, settings))};
    if (HasReference(source.head)) {
      runs.push_back(SimulateReference(model, reference, settings.noise.reference, source.whole()));
    }
    return runs;
  }

  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel& model,
                       const Instruments& on, const FactsByRun&) const override {
    const relm::LinkageSettings& settings = on.LinkageFor(recording.name);
    const LinkageSimulation nominal = Nominal(on, settings);
    LinkageRun run = AtMost(MeansOfStays(ReadLinkageRun(recording, settings)), kMostDiagnosedPoses);
    Trace trace = TraceOf(recording, run, nominal);
    CountIndependent(settings.noise, trace.duration, run);
    return {{{SimulateLinkage(model, on.machine.reference, nominal, run), std::move(trace)}}};
  }

  void RefuseStrangers(const std::vector<RunSource>& sources,
                       const Instruments& on) const override {
    if (on.linkage) RefuseOtherBalls(sources, *on.linkage);
  }

  Correction Correct(const Recording& recording, const std::vector<ModelledCause>& causes,
                     const Origin& origin, const Instruments& on) const override {
    return CorrectLinkage(recording, causes, origin, on);
  }

  // A part of a run would not know which way its axes last turned.
  std::optional<std::string> HeldOutGroup(const Recording& recording) const override {
    return BaseOf(recording);
  }
  RowRule HeldOut(const Recording& recording) const override {
    return EverySecondPassOrBlock(recording);
  }

  Recording Plan(Recording path, const Instruments& on) const override {
    FlagPlaces(path);
    PlanAngles(on, path);
    return path;
  }

  // Slow circles, and stands in the whole volume; the fast circles are there always.
  std::vector<NextRun> FirstRuns(const Instruments& on, const PathAbout& about) const override {
    if (!on.linkage || !on.HasAxes()) return {};
    const Volume volume(on.machine.travels);
    std::vector<NextRun> runs;
    for (const char* plane : {"XY", "YZ", "ZX"}) {
      runs.push_back(CircleRun({.plane = plane,
                                .centre = volume.middle,
                                .radius = volume.smallest / 3.0,
                                .feed = kSlow,
                                .mounting = BaseLines(kFirstBase)},
                               about));
    }
    const Vector3d share(25.0 / 60.0, 25.0 / 60.0, 50.0 / 60.0);
    runs.push_back({"stand at 80 places of a cube with the linkage",
                    GridPath({.middle = volume.middle,
                              .size = share.cwiseProduct(volume.size),
                              .counts = {4, 4, 5},
                              .feed = kFast,
                              .mounting = BaseLines(kFirstBase)},
                             about)});
    return runs;
  }

  std::vector<NextRun> NextRuns(const std::vector<const Recording*>& recorded,
                                const Instruments& on, const PathAbout& about) const override {
    if (!on.linkage) return {};
    return AfterLinkage(recorded, on, about).Make();
  }
};

}  // namespace

void RefuseOtherBalls(const std::vector<RunSource>& sources, const relm::LinkageSettings& linkage,
                      const std::string& advice) {
  constexpr Index kMost = 4096, kSample = 1024;  // poses of a run
  OneBall ball(advice);
  for (const RunSource& source : sources) {
    const LinkageParts parts = PartsOf(source.blocks, linkage);
    ball.Add(source.head, SampleOf(parts, kMost, kSample).run);
  }
}

std::string BaseLines(const std::string& base) {
  return fmt::format("base = {}\n", settings::Quoted(base));
}

std::string BaseOf(const Recording& run) { return run.HeaderText("mounting.base").value_or(""); }

const RunKind& LinkageKind() {
  static const LinkageRuns kind;
  return kind;
}

}  // namespace abbe::simulation
