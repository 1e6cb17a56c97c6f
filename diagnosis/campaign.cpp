#include "diagnosis/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/reference_in_campaign.h"
#include "diagnosis/shaft_in_campaign.h"
#include "failure/failure.h"
#include "recording/made_on.h"
#include "simulation/length_simulation.h"
#include "simulation/linkage_on_machine.h"
#include "simulation/reference_trace.h"
#include "simulation/sweep_simulation.h"
#include "simulation/target_spots.h"

namespace abbe::diagnosis {

using simulation::Trace;

namespace {

constexpr Eigen::Index kMostPoses = 1500;  // of one run: time is spent on causes, not on rows

simulation::LinkageRun Thinned(const simulation::LinkageRun& run) {
  if (run.poses() <= kMostPoses) return run;
  std::vector<Eigen::Index> kept;
  const Eigen::Index step = (run.poses() + kMostPoses - 1) / kMostPoses;
  for (Eigen::Index pose = 0; pose < run.poses(); pose += step) kept.push_back(pose);
  return simulation::Selection(run, kept);
}

// No dwell of a head has an angle of a shaft.
std::string KindOf(const recording::Recording& recording) {
  std::string kind = recording.Kind();
  const bool turns = recording.Find("shaft_deg") || recording.Find("shaft_rad");
  return kind == "dwell" && turns ? "shaft" : kind;
}

// The slope of a Gaussian process: its deviation over its length (fusion/machine_prior.h).
Eigen::Matrix<double, 6, 3> SlopesOf(const machine::Population& population) {
  Eigen::Matrix<double, 6, 3> slopes;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      slopes(motion, axis) =
          fusion::PopulationDeviation(population, axis, motion) / population.smoothness;
    }
    slopes(axis, axis) = std::hypot(slopes(axis, axis), population.scale);
  }
  return slopes;
}

}  // namespace

Campaign::Campaign(Setup setup, std::optional<simulation::Origin> origin)
    : setup_(std::move(setup)),
      model_(fusion::UnknownMachine(setup_.machine)),
      prior_(setup_.machine, model_, setup_.machine.population.smoothness),
      origin_(std::move(origin)),
      notes_(setup_.notes) {}

void Campaign::Add(recording::Recording recording) {
  const machine::Machine& mill = setup_.machine;
  recording::RefuseOtherMachine(recording, mill.name);
  for (BadData& bad : FlagBadRows(recording)) {
    bad_.push_back({simulation::StartedOf(recording), std::move(bad)});
  }
  const std::string kind = KindOf(recording);
  if (kind == "sweep" || kind == "dwell" || kind == "gap-steps") {
    if (!setup_.head) {
      throw InputError(fmt::format(
          "{}: the machine file has no table [head]; add it or leave the run out", recording.name));
    }
    const simulation::SweepRun run =
        kind == "sweep" ? simulation::ReadSweepDwells(recording, *setup_.head, setup_.noise)
        : kind == "dwell"
            ? simulation::ReadStillReadings(recording, setup_.noise)
            : simulation::ReadGapSteps(recording, setup_.noise, SlopesOf(mill.population));
    runs_.push_back(
        {simulation::SimulateSweep(model_, mill.reference, {*setup_.head, setup_.target}, run),
         simulation::TraceOf(recording, run)});
    runs_.back().trace.spots = simulation::SpotsOnTarget(mill.chain, *setup_.head, run);
  } else if (kind == "linkage") {
    if (!setup_.linkage) {
      throw InputError(
          fmt::format("{}: the machine file has no table [linkage]; add it or leave the run out",
                      recording.name));
    }
    const simulation::LinkageSimulation linkage(
        mill.chain, *setup_.linkage,
        relm::MakeLinkageModel(*setup_.linkage, relm::ErrorModel::kComplete));
    const auto run =
        Thinned(simulation::MeansOfStays(simulation::ReadLinkageRun(recording, *setup_.linkage)));
    runs_.push_back({simulation::SimulateLinkage(model_, mill.reference, linkage, run),
                     simulation::TraceOf(recording, run, linkage)});
  } else if (kind == "length") {
    runs_.push_back({simulation::SimulateLengths(model_, mill.reference, recording),
                     simulation::TraceOfLengths(recording)});
  } else if (kind == "reference") {
    runs_.push_back(MakeReferenceRun(recording, setup_, model_, notes_));
  } else if (kind == "shaft") {
    runs_.push_back(MakeShaftRun(recording, setup_, notes_));
  } else {
    throw InputError(
        fmt::format("{}: kind is \"{}\"; diagnose takes sweep, dwell, gap-steps, linkage, "
                    "reference, length and shaft",
                    recording.name, kind));
  }
  runs_.back().simulated.loss = estimation::RobustLoss::None();
  const simulation::Origin start = origin();
  for (DiagnosedRun& run : runs_) {
    if (run.trace.rows() > 0) simulation::CountFrom(start, run.trace);
  }
}

simulation::Origin Campaign::origin() const {
  return origin_ ? *origin_ : simulation::OriginOf(scene().traces);
}

std::vector<BadData> Campaign::bad_data() const {
  std::vector<BadData> all;
  const double start = origin().started;
  for (const auto& [started, found] : bad_) {
    BadData bad = found;
    bad.from += started - start;
    bad.to += started - start;
    const auto known = std::find_if(all.begin(), all.end(), [&](const BadData& other) {
      return other.cause == bad.cause && other.object == bad.object;
    });
    if (known == all.end()) {
      all.push_back(bad);
      continue;
    }
    known->from = std::min(known->from, bad.from);
    known->to = std::max(known->to, bad.to);
    known->count += bad.count;
  }
  return all;
}

simulation::Scene Campaign::scene() const {
  simulation::Scene scene;
  for (const DiagnosedRun& run : runs_) {
    if (run.trace.rows() > 0) scene.traces.push_back(&run.trace);
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto& travel = setup_.machine.travels[static_cast<std::size_t>(axis)];
    scene.travel[axis] = travel.last - travel.first;
  }
  if (setup_.head) {
    scene.form = setup_.target.form;
    scene.form_length = setup_.target.form_length;
  }
  return scene;
}

}  // namespace abbe::diagnosis
