// Circles under a ballbar: radii alone (ballbar_simulation.h).
//
// In a diagnosis and a map every reading counts, up to kMostRadii of a run. Rows are on the way of
// the axes; where the recording has no times they follow from its feed. Held out: every second
// pass, else every second block of time.
#include <fmt/format.h>

#include <array>
#include <memory>

#include "settings/toml_text.h"
#include "settings/unit.h"
#include "simulation/ballbar/ballbar_simulation.h"
#include "simulation/kinds.h"
#include "simulation/planned_run.h"
#include "simulation/points/point_correction.h"
#include "simulation/trace_columns.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using recording::Recording;

constexpr Index kMostRadii = 2000;  // of one run: more tell no more of causes
constexpr double kSlowCircle = 500.0 * settings::kMillimetrePerMinute;
constexpr double kFastCircle = 2500.0 * settings::kMillimetrePerMinute;

bool Reaches(const std::array<machine::Travel, 3>& travels, const Vector3d& centre,
             const CirclePlan& circle) {
  for (const char axis : circle.plane) {
    const auto& [first, last] = travels[axis - 'X'];
    if (centre[axis - 'X'] - circle.radius < first) return false;
    if (centre[axis - 'X'] + circle.radius > last) return false;
  }
  return true;
}

struct BallbarFacts : RunFacts {
  explicit BallbarFacts(double noise) : sd(noise) {}
  double sd;  // m, by the readings of the whole run
};

// The noise of a part is that of the whole.
BallbarRun ReadPart(const Recording& recording, const FactsByRun& known) {
  const auto facts = FactsAs<BallbarFacts>(known, recording.name);
  return ReadBallbarRun(recording, facts ? facts->sd : 0.0);
}

Trace TraceOf(const Recording& recording, const BallbarRun& run) {
  Trace trace;
  trace.name = run.points.name;
  trace.on_the_way = OnTheWay::kWhileMoving;
  trace.continuous = run.times_known;
  trace.started = StartedOf(recording);
  trace.time = trace.clock = run.time;
  trace.pass = run.pass;
  trace.direction.assign(run.pass.size(), 0);
  trace.SetAxes(run.points.axes);
  AddSensors(recording, run.points.rows, trace);
  return trace;
}

std::string ScatterText(const BallbarRun& run) {
  if (run.sd <= kFinestBallbarNoise) {
    return fmt::format(
        "{}: neighbouring readings scatter by less than any ballbar tells apart: {:.2g} um taken",
        run.points.name, kFinestBallbarNoise / settings::kMicrometre);
  }
  return fmt::format("{}: noise of the ballbar by how far neighbouring readings scatter: {:.2g} um",
                     run.points.name, run.sd / settings::kMicrometre);
}

void NoteTimes(const Recording& recording, const BallbarRun& run, std::vector<std::string>& notes) {
  if (run.times_known) return;
  if (!run.feed_known) return NoteUnknownTimes(recording, notes);
  notes.push_back(fmt::format("{}: has no times; they follow from its feed, passes a second apart",
                              run.points.name));
}

class BallbarRuns : public RunKind {
 public:
  std::string_view name() const override { return "ballbar"; }
  bool Takes(const Recording& head) const override { return head.Kind() == name(); }

  // The centre ball stands anew in each plane.
  std::string MountingOf(const Recording& head) const override {
    return head.HeaderText("axis").value_or("");
  }

  bool MakesMaps() const override { return true; }
  std::vector<SimulatedRun> ForMap(const RunSource& source, const machine::VolumetricModel& model,
                                   const Instruments& on) const override {
    const BallbarRun run = Thinned(ReadBallbarRun(source.whole()), kMostRadii);
    return {SimulateBallbar(model, on.machine.reference, run)};
  }

  PreparedRuns Prepare(const Recording& recording, const machine::VolumetricModel& model,
                       const Instruments& on, const FactsByRun& known) const override {
    PreparedRuns prepared;
    const BallbarRun run = Thinned(ReadPart(recording, known), kMostRadii);
    prepared.facts = std::make_shared<const BallbarFacts>(run.sd);
    if (!run.states_noise) prepared.notes.push_back(ScatterText(run));
    NoteTimes(recording, run, prepared.notes);
    prepared.runs.push_back(
        {SimulateBallbar(model, on.machine.reference, run), TraceOf(recording, run)});
    return prepared;
  }

  Correction Correct(const Recording& recording, const std::vector<ModelledCause>& causes,
                     const Origin& origin, const Instruments& on) const override {
    const BallbarRun run = ReadBallbarRun(recording);
    return CorrectPoints(WithAllPositions(recording),
                         {{run.points, TraceOf(recording, run), run.points.rows}}, causes, origin,
                         on);
  }

  RowRule HeldOut(const Recording& recording) const override {
    return EverySecondPassOrBlock(recording);
  }

  // The other planes about the same centre, as far as the travels reach, and another feed.
  std::vector<NextRun> NextRuns(const std::vector<const Recording*>& recorded,
                                const Instruments& on, const PathAbout& about) const override {
    std::vector<NextRun> runs;
    if (recorded.empty()) return runs;
    const BallbarRun last = ReadBallbarRun(*recorded.back());
    const double radius = recorded.back()->HeaderNumber("radius_mm").value_or(0.0);
    if (!(radius > 0.0)) return runs;
    for (const char* plane : {"XY", "YZ", "ZX"}) {
      for (const double feed : {kSlowCircle, kFastCircle}) {
        CirclePlan plan{.plane = plane,
                        .centre = Vector3d::Zero(),
                        .radius = radius * settings::kMillimetre,
                        .feed = feed,
                        .mounting = {},
                        .kind = "ballbar"};
        if (!Reaches(on.machine.travels, last.centre, plan)) continue;
        if (!last.ballbar.empty()) {
          plan.mounting = fmt::format("ballbar = {}\n", settings::Quoted(last.ballbar));
        }
        const Vector3d centre = last.centre / settings::kMillimetre;
        plan.more = fmt::format("axis = \"{}\"\nradius_mm = {}\ncentre_mm = [{}, {}, {}]\n", plane,
                                radius, centre[0], centre[1], centre[2]);
        runs.push_back({fmt::format("a ballbar circle in {} at {:.0f} mm/min", plane,
                                    feed / settings::kMillimetrePerMinute),
                        CirclePath(plan, about)});
      }
    }
    return runs;
  }

  Recording Plan(Recording path, const Instruments&) const override {
    FlagPlaces(path);
    const auto x = path.At("x_mm"), y = path.At("y_mm"), z = path.At("z_mm");
    std::vector<double> radius(path.rows());
    for (std::size_t row = 0; row < radius.size(); ++row) {
      radius[row] = Vector3d(x[row], y[row], z[row]).norm();
    }
    ColumnIn(path, "ref_radius_mm") = std::move(radius);
    return path;
  }
};

}  // namespace

const RunKind& BallbarKind() {
  static const BallbarRuns kind;
  return kind;
}

}  // namespace abbe::simulation
