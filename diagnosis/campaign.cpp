#include "diagnosis/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "diagnosis/extended_run.h"
#include "diagnosis/invalid_readings.h"
#include "diagnosis/remembering_run.h"
#include "estimation/in_parallel.h"
#include "failure/failure.h"
#include "recording/made_on.h"
#include "simulation/kinds.h"
#include "simulation/remembered_noise.h"

namespace abbe::diagnosis {
namespace {

machine::VolumetricModel ModelOf(const simulation::Instruments& instruments) {
  const machine::Machine& mill = instruments.machine;
  if (instruments.HasAxes()) return fusion::UnknownMachine(mill);
  return {mill.chain, mill.travels};
}

void RequireAxes(const recording::Recording& recording, const simulation::RunKind& kind,
                 const simulation::Instruments& instruments) {
  if (!kind.NeedsAxes() || instruments.HasAxes()) return;
  throw InputError(fmt::format(
      "{}: the machine file has no axes (chain, [axis.X], [axis.Y], [axis.Z]); without them only "
      "a turning shaft (kind shaft) and an arm before an instrument can be diagnosed: kind "
      "linkage, with ref_x_mm, ref_y_mm, ref_z_mm and no x_mm, y_mm, z_mm",
      recording.name));
}

// Each cause and object once.
void AddTo(std::vector<InvalidReadings>& all, const InvalidReadings& readings) {
  const auto known = std::find_if(all.begin(), all.end(), [&](const InvalidReadings& other) {
    return other.cause == readings.cause && other.object == readings.object;
  });
  if (known == all.end()) {
    all.push_back(readings);
    return;
  }
  known->from = std::min(known->from, readings.from);
  known->to = std::max(known->to, readings.to);
  known->count += readings.count;
}

}  // namespace

Campaign::Campaign(simulation::Instruments instruments)
    : instruments_(std::move(instruments)),
      model_(ModelOf(instruments_)),
      prior_(instruments_.machine, model_, instruments_.machine.population.smoothness),
      notes_(instruments_.notes) {}

Campaign Campaign::WithoutRuns() const {
  Campaign empty(instruments_);
  empty.model_ = model_;
  empty.prior_ = prior_;
  if (origin_ || !runs_.empty()) empty.origin_ = origin();
  empty.facts_ = facts_;
  empty.carried_ = carried_;
  empty.strays_ = strays_;
  return empty;
}

Campaign Campaign::With(const fusion::ErrorPopulation& population,
                        const std::array<double, machine::kAxes>& knots,
                        const machine::Population& lines) const {
  Campaign other = WithoutRuns();
  other.instruments_.machine.population = lines;
  other.model_ = fusion::UnknownMachine(instruments_.machine, knots);
  other.prior_ = {instruments_.machine, other.model_, population};
  std::vector<Given> same;
  for (const Given& given : given_) same.push_back({given.recording, given.flagged});
  other.Prepare(std::move(same));
  return other;
}

Campaign Campaign::Without(const std::vector<StrayReadings>& strays) const {
  Campaign other = WithoutRuns();
  other.strays_ = strays;
  std::vector<Given> rest;
  for (const Given& given : given_) {
    recording::Recording recording = *given.recording;
    rest.push_back({nullptr, given.flagged});
    other.LeaveStraysOut(recording, rest.back().flagged);
    rest.back().recording = std::make_shared<const recording::Recording>(std::move(recording));
  }
  other.Prepare(std::move(rest));
  other.strays_.insert(other.strays_.begin(), strays_.begin(), strays_.end());
  return other;
}

void Campaign::LeaveStraysOut(recording::Recording& recording,
                              std::vector<InvalidReadings>& flagged) const {
  for (const StrayReadings& each : strays_) {
    if (each.run != recording.name) continue;
    InvalidReadings found = FlagOutliers(recording, each.object, each.times);
    if (found.count > 0) flagged.push_back(std::move(found));
  }
}

void Campaign::Add(recording::Recording recording) {
  std::vector<recording::Recording> one;
  one.push_back(std::move(recording));
  Add(std::move(one));
}

void Campaign::Add(std::vector<recording::Recording> recordings) {
  std::vector<Given> given(recordings.size());
  estimation::InParallel(recordings.size(), [&](std::size_t i) {
    recording::Recording& recording = recordings[i];
    recording::RefuseOtherMachine(recording, instruments_.machine.name);
    const simulation::RunKind& kind = simulation::KindOf(recording);
    RequireAxes(recording, kind, instruments_);
    if (kind.RowsFollowEachOther()) given[i].flagged = FlagInvalidReadings(recording);
    LeaveStraysOut(recording, given[i].flagged);
    given[i].recording = std::make_shared<const recording::Recording>(std::move(recording));
  });
  Prepare(std::move(given));
}

void Campaign::Prepare(std::vector<Given> given) {
  std::vector<std::optional<simulation::PreparedRuns>> prepared(given.size());
  const auto prepare = [&](std::size_t i) {
    const recording::Recording& recording = *given[i].recording;
    prepared[i] = simulation::KindOf(recording).Prepare(recording, model_, instruments_, facts_);
  };
  // The first of a name has the facts of all of that name.
  std::set<std::string> names;
  std::vector<bool> is_alone;
  is_alone.reserve(given.size());
  for (const Given& each : given) is_alone.push_back(names.insert(each.recording->name).second);
  estimation::InParallel(given.size(), [&](std::size_t i) {
    if (is_alone[i] && !simulation::KindOf(*given[i].recording).AsksForOthers()) prepare(i);
  });
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!prepared[i]) prepare(i);
    Enter(std::move(given[i]), std::move(*prepared[i]));
  }
}

void Campaign::Enter(Given given, simulation::PreparedRuns prepared) {
  given.in_preparing = std::move(prepared.invalid);
  if (prepared.facts) facts_.emplace(given.recording->name, std::move(prepared.facts));
  given_.push_back(std::move(given));
  std::move(prepared.notes.begin(), prepared.notes.end(), std::back_inserter(notes_));
  for (PreparedRun& run : prepared.runs) {
    run.simulated.loss = estimation::RobustLoss::None();
    run.simulated = Remembering(std::move(run.simulated));
    runs_.push_back(std::move(run));
  }
  const simulation::Origin start = origin();
  for (PreparedRun& run : runs_) {
    FreeForCauses(scene(), run.simulated.blocks);
    if (run.trace.rows() > 0) simulation::CountFrom(start, run.trace);
  }
  NumberRuns();
}

void Campaign::NumberRuns() {
  std::vector<simulation::Trace*> in_time;
  for (PreparedRun& run : runs_) in_time.push_back(&run.trace);
  std::ranges::stable_sort(in_time, {}, &simulation::Trace::started);
  for (int number = 0; simulation::Trace * trace : in_time) trace->number = number++;
}

void Campaign::CarryOn(std::vector<std::shared_ptr<const simulation::LearnedCause>> carried) {
  carried_ = std::move(carried);
}

simulation::Origin Campaign::origin() const {
  return origin_ ? *origin_ : simulation::OriginOf(scene().traces);
}

bool Campaign::EstimatesNoise() const {
  return std::ranges::any_of(runs_, &PreparedRun::EstimatesNoise);
}

bool Campaign::SetExcess(const std::vector<double>& excess, Change change) {
  constexpr double kMuchMore = 4.0 / 3.0, kLess = 0.95;
  bool changed = false;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    PreparedRun& run = runs_[r];
    if (!run.EstimatesNoise()) continue;
    const double ratio = excess[r] / run.excess;
    if (change == Change::kUp ? ratio < kMuchMore : ratio > kLess) continue;
    run.excess = excess[r];
    run.simulated = Remembering(run.with_excess(excess[r]));
    FreeForCauses(scene(), run.simulated.blocks);
    changed = true;
  }
  return changed;
}

void Campaign::SetMemory(std::size_t run, const estimation::NoiseMemory& noise) {
  PreparedRun& prepared = runs_[run];
  prepared.simulated =
      Remembering(simulation::WithMemory(prepared.simulated, prepared.trace.time, noise));
  prepared.excess *= noise.sd();
  prepared.memory = noise;
}

std::vector<InvalidReadings> Campaign::invalid_readings() const {
  std::vector<InvalidReadings> all;
  for (const Given& given : given_) {
    const double later = simulation::StartedOf(*given.recording) - origin().started;
    for (const auto& some : {given.flagged, given.in_preparing}) {
      for (InvalidReadings readings : some) {
        readings.from += later;
        readings.to += later;
        AddTo(all, readings);
      }
    }
  }
  return all;
}

simulation::Scene Campaign::scene() const {
  simulation::Scene scene;
  for (const PreparedRun& run : runs_) {
    if (run.trace.rows() > 0) scene.traces.push_back(&run.trace);
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto& travel = instruments_.machine.travels[axis];
    scene.travel[axis] = travel.last - travel.first;
    scene.first[axis] = travel.first;
  }
  if (instruments_.head) {
    scene.form = instruments_.target.form;
    scene.form_length = instruments_.target.form_length;
  }
  return scene;
}

}  // namespace abbe::diagnosis
